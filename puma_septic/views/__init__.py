"""Documents as text, HTML and CSV: strings only, and nothing that is not in the document."""
