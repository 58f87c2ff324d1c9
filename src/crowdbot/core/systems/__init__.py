"""What differs between Linux, macOS and Windows; code for one of them stands in these files where it can."""
