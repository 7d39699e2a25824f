"""The labs' pictures: one function for each, moved by sliders."""
