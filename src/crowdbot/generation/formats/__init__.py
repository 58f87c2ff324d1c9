"""Formats of generated data: npz, Parquet, WebDataset and COCO."""
