"""The answers to the questions of the labs, one file for each chapter."""
