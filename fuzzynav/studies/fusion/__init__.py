"""Thesis 4: our choices for what is not printed, the studies of them, and what each claim measures here."""
