"""Names of variables and terms: one word that a rule text can hold."""

__all__ = ["check_name"]

_KEYWORDS = frozenset({"if", "is", "then", "and", "or", "with"})


def check_name(name: object, what: str) -> None:
    """Raise ValueError unless `name` is one word that a rule text can hold."""
    fits = isinstance(name, str) and name and name.lower() not in _KEYWORDS
    if not fits or any(c.isspace() or c in "(),;#:" for c in str(name)):
        raise ValueError(f"{what} name {name!r} must be one word, without brackets or , ; : # and not a rule keyword")
