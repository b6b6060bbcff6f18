"""Files that were uploaded: read by processes of their own, kept by their ids."""
