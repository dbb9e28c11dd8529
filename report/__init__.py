"""What a person looks at: figures, the annotated clip, the page."""
