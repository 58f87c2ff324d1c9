"""Text formats: XML trees and SVG drawings."""
