"""What all rooms share: tables of tracks, the sheet's numbers, files in and out."""
