"""Rules: propositions, their combinations, and the text that they are written in.

The grammar is that of FuzzyLite: `if a is not Low and (b is High or c is any) then d is Left with 0.5`;
`and` binds before `or`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import KW_ONLY, dataclass

from fuzzynav.fuzzy.names import check_name
from fuzzynav.fuzzy.operators import HEDGES

__all__ = ["And", "Antecedent", "Or", "Proposition", "Rule", "propositions"]


_DEPTH = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposition:
    """`variable is term`, with hedges between them in written order; the term is empty after the hedge any."""

    variable: str
    term: str = ""
    hedges: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_name(self.variable, "variable")
        if isinstance(self.hedges, str) or not isinstance(self.hedges, Iterable):
            raise ValueError(f"the hedges before a term must be a tuple of words, got {self.hedges!r}")
        object.__setattr__(self, "hedges", tuple(self.hedges))
        for word in self.hedges:
            if word not in HEDGES:
                raise ValueError(f"unknown hedge {word!r} before {self.term!r}; known: {', '.join(HEDGES)}")
        if self.term:
            check_name(self.term, "term")
        elif not self.hedges or self.hedges[-1] != "any":
            raise ValueError(f"'{self.variable} is' must be followed by a term, or end with the hedge any")

    def __str__(self) -> str:
        return " ".join([self.variable, "is", *self.hedges, self.term]).rstrip()


@dataclass(frozen=True, slots=True, kw_only=True)
class And:
    """All parts hold."""

    parts: tuple[Antecedent, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _flat(self.parts, And))

    def __str__(self) -> str:
        return " and ".join(f"({part})" if isinstance(part, Or) else str(part) for part in self.parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Or:
    """At least one part holds."""

    parts: tuple[Antecedent, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", _flat(self.parts, Or))

    def __str__(self) -> str:
        return " or ".join(str(part) for part in self.parts)


Antecedent = Proposition | And | Or


def _flat(parts: tuple[Antecedent, ...], kind: type[And] | type[Or]) -> tuple[Antecedent, ...]:
    """The parts with nested ones of the same kind opened: a and (b and c) is a and b and c."""
    parts = tuple(parts) if isinstance(parts, Iterable) else ()
    if len(parts) < 2 or not all(isinstance(part, (Proposition, And, Or)) for part in parts):
        raise ValueError(f"{kind.__name__} joins two or more propositions, got {parts!r}")
    return tuple(inner for part in parts for inner in (part.parts if isinstance(part, kind) else (part,)))


def propositions(antecedent: Antecedent) -> Iterator[Proposition]:
    """Each proposition of an antecedent, in written order."""
    if isinstance(antecedent, Proposition):
        yield antecedent
        return
    for part in antecedent.parts:
        yield from propositions(part)


@dataclass(frozen=True, slots=True)
class Rule:
    """If the antecedent holds, then each consequent does, as strongly, times the weight.

    Raises ValueError for parts of another kind or a weight outside 0 to 1; `Rule.parse` reads a rule in words.
    """

    antecedent: Antecedent
    _: KW_ONLY
    consequents: tuple[Proposition, ...] = ()
    weight: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.antecedent, (Proposition, And, Or)):
            raise ValueError(
                f"the antecedent of a rule must be a Proposition, And or Or, got {self.antecedent!r}; Rule.parse reads "
                "a rule in words"
            )
        consequents = tuple(self.consequents) if isinstance(self.consequents, Iterable) else ()
        if not consequents or not all(isinstance(c, Proposition) and c.term for c in consequents):
            raise ValueError(f"a rule needs consequents of the form 'output is term', got {self.consequents!r}")
        try:
            weight = float(self.weight)
        except (TypeError, ValueError):
            weight = math.nan
        if not 0.0 <= weight <= 1.0:
            raise ValueError(f"the weight of a rule must be from 0 to 1, got {self.weight!r}")
        object.__setattr__(self, "consequents", consequents)
        object.__setattr__(self, "weight", weight)

    @classmethod
    def parse(cls, text: str) -> Rule:
        """Rule written in the FuzzyLite grammar.

        Raises ValueError that quotes the text and says what was expected.

        >>> rule = Rule.parse("if headGoal is Little and distObs is not Close then alpha is Low with 0.5")
        >>> rule.antecedent.parts[1].hedges, rule.weight
        (('not',), 0.5)
        """
        if not isinstance(text, str):
            raise ValueError(f"a rule must be text such as 'if a is Low then b is High', got {text!r}")
        return _Parser(text).rule()

    def __str__(self) -> str:
        then = " and ".join(str(part) for part in self.consequents)
        weight = "" if self.weight == 1.0 else f" with {self.weight!r}"
        return f"if {self.antecedent} then {then}{weight}"


class _Parser:
    """Recursive descent over the words of one rule."""

    def __init__(self, text: str) -> None:
        self.text = " ".join(text.split())
        self.words: list[str] = re.findall(r"[()]|[^\s()]+", text)
        self.at = 0
        self.depth = 0

    def fail(self, expected: str) -> ValueError:
        got = f"{self.words[self.at]!r}" if self.at < len(self.words) else "the end"
        return ValueError(f"rule {self.text!r}: expected {expected}, got {got} (word {self.at + 1})")

    def peek(self) -> str:
        return self.words[self.at].lower() if self.at < len(self.words) else ""

    def accept(self, word: str) -> bool:
        found = self.peek() == word
        self.at += found
        return found

    def expect(self, word: str) -> None:
        if not self.accept(word):
            raise self.fail(f"{word!r}")

    def rule(self) -> Rule:
        self.expect("if")
        antecedent = self.any_of()
        self.expect("then")
        consequents = [self.proposition()]
        while self.accept("and"):
            consequents.append(self.proposition())
        weight = self.number() if self.accept("with") else 1.0
        if self.at < len(self.words):
            raise self.fail("the end of the rule")
        try:
            return Rule(antecedent=antecedent, consequents=tuple(consequents), weight=weight)
        except ValueError as error:
            raise ValueError(f"rule {self.text!r}: {error}") from None

    def any_of(self) -> Antecedent:
        parts = [self.all_of()]
        while self.accept("or"):
            parts.append(self.all_of())
        return parts[0] if len(parts) == 1 else Or(parts=tuple(parts))

    def all_of(self) -> Antecedent:
        parts = [self.primary()]
        while self.accept("and"):
            parts.append(self.primary())
        return parts[0] if len(parts) == 1 else And(parts=tuple(parts))

    def primary(self) -> Antecedent:
        if not self.accept("("):
            return self.proposition()
        self.depth += 1
        if self.depth > _DEPTH:
            raise ValueError(f"rule {self.text[:40]!r}...: more than {_DEPTH} brackets inside one another")
        inner = self.any_of()
        self.expect(")")
        self.depth -= 1
        return inner

    def word(self, what: str) -> str:
        if self.peek() in ("", "if", "is", "and", "or", "then", "with", "(", ")"):
            raise self.fail(what)
        self.at += 1
        return self.words[self.at - 1]

    def proposition(self) -> Proposition:
        variable = self.word("a variable")
        self.expect("is")
        words = [self.word("a term")]
        while self.peek() not in ("", "and", "or", "then", "with", ")"):
            words.append(self.word("a term"))
        term = "" if words[-1] == "any" else words.pop()
        try:
            return Proposition(variable=variable, term=term, hedges=tuple(words))
        except ValueError as error:
            raise ValueError(f"rule {self.text!r}: {error}") from None

    def number(self) -> float:
        word = self.word("a weight")
        try:
            return float(word)
        except ValueError:
            self.at -= 1
            raise self.fail("a weight between 0 and 1") from None
