"""Plain English and plain names: banned identifiers, first words of docstrings, length of sentences.

`python tests/language.py [PATH ...]` prints each violation with its file and line; without a path, those of all files.
"""

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("docs", "gyrodrift", "firmware_sim", "benchmark/gyrogap")

PRONOUNS = frozenset(
    [
        "asked",
        "at",
        "both",
        "each",
        "found",
        "held",
        "known",
        "left",
        "more",
        "one",
        "other",
        "others",
        "place",
        "said",
        "seen",
        "such",
        "these",
        "those",
        "told",
        "wanted",
    ]
)
"""Words that do not say what a value is, as a whole identifier."""

PRIVATE_WORDS = frozenset(
    [
        "alike",
        "anew",
        "beside",
        "caution",
        "claim",
        "claims",
        "doubt",
        "excused",
        "forgive",
        "gentle",
        "kin",
        "lookalike",
        "loud",
        "mute",
        "rival",
        "rivals",
        "room",
        "rooms",
        "settle",
        "settled",
        "strange",
        "turned",
        "unearned",
        "wild",
    ]
)
"""Words without a meaning outside of this project, as a part of an identifier."""

PRIVATE_PHRASES = re.compile(
    r"\b(?:anew|look-?alikes?|rooms|held back|take[ns]? back|stands? out|unearned)\b", re.IGNORECASE
)
FIRST_WORDS = re.compile(r"(?:What|Where|Of|By|That|Which|Those|The same|As|Who)\b")
MOST_WORDS = 26
"""About 20 words are the aim; a sentence above this is two."""

FENCE = re.compile(r"^( *)(```|~~~).*?^\1\2", re.MULTILINE | re.DOTALL)
SENTENCE_END = re.compile(r"(?<=[.!?;:])[)\"'*_]*\s+|\n\s*\n|\n\s*(?:[-*+]|\d+\.)\s|\|")


def bound_names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Identifiers that a file chooses: of variables, parameters, functions, classes and fields."""
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()):
                yield node.lineno, name
            case ast.arg(arg=name):
                yield node.lineno, name
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield node.lineno, name


def is_banned(name: str) -> bool:
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_").split("_")
    return "_".join(words) in PRONOUNS or not PRIVATE_WORDS.isdisjoint(words)


def equality_parameters(tree: ast.AST) -> set[int]:
    """Lines of the `other` of comparison and arithmetic methods, which Python calls so."""
    return {
        argument.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name.startswith("__")
        for argument in node.args.args
    }


def docstrings(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Texts in docstring position: of modules, classes and functions, and below constants and fields."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Lambda | ast.IfExp):
            continue
        for statement in getattr(node, "body", ()):
            match statement:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    yield statement.lineno, text


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Runs of comment lines as one text."""
    run: list[str] = []
    start = last = 0
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and not token.string.startswith("#!"):
            if run and token.start[0] != last + 1:
                yield start, "\n".join(run)
                run = []
            start = start if run else token.start[0]
            last = token.start[0]
            run.append(token.string.lstrip("# "))
    if run:
        yield start, "\n".join(run)


def sentences(text: str) -> Iterator[str]:
    """Sentences and table cells of prose; a code span or a link counts as its text, a formula as a word."""
    text = FENCE.sub("\n\n", text)
    text = re.sub(r"`[^`]*`", "code", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    for sentence in SENTENCE_END.split(text):
        if sentence and sentence.strip():
            yield " ".join(sentence.split())


def words(sentence: str) -> int:
    """Words with a letter in them: figures and signs are no reading."""
    return len(re.findall(r"[^\W\d_][\w'’.-]*", sentence))


def violations_of_source(source: str) -> Iterator[tuple[int, str]]:
    """Lines of a Python file that break a rule, each with the rule."""
    tree = ast.parse(source)
    allowed = equality_parameters(tree)
    for line, name in bound_names(tree):
        if is_banned(name) and not (name == "other" and line in allowed):
            yield line, f"the name does not say what the value is: {name}"
    for line, text in docstrings(tree):
        if FIRST_WORDS.match(text):
            yield line, f"a docstring begins with a verb or a noun of the field: {text.splitlines()[0]}"
    for line, text in [*docstrings(tree), *comments(source)]:
        yield from ((line, sentence) for sentence in violations_of_prose(text))


def violations_of_prose(text: str) -> Iterator[str]:
    """Sentences that are too long, and phrases that only this project knows."""
    for sentence in sentences(text):
        if words(sentence) > MOST_WORDS:
            yield f"{words(sentence)} words, at most {MOST_WORDS}: {sentence}"
    for phrase in PRIVATE_PHRASES.findall(FENCE.sub("", text)):
        yield f"only this project knows the phrase: {phrase}"


def violations(path: Path) -> list[str]:
    """Violations of a page or a Python file, as `path:line: text`; a page has no lines."""
    text = path.read_text()
    name = path.relative_to(ROOT) if path.is_relative_to(ROOT) else path
    if path.suffix == ".md":
        return [f"{name}: {violation}" for violation in violations_of_prose(text)]
    return [f"{name}:{line}: {violation}" for line, violation in sorted(violations_of_source(text))]


def files(places: Iterable[Path]) -> list[Path]:
    """Pages and Python files at and below some places."""
    return sorted(
        path
        for position in places
        for path in ([position] if position.is_file() else position.rglob("*"))
        if path.suffix in {".md", ".py"}
    )


if __name__ == "__main__":
    chosen = [Path(word).resolve() for word in sys.argv[1:]] or [ROOT / name for name in ("README.md", *PACKAGES)]
    lines = [line for path in files(chosen) for line in violations(path)]
    print("\n".join(lines))
    sys.exit(bool(lines))
