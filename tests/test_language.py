"""Everything written for a person is plain English, and every name says what the value is."""

import ast
import subprocess
import sys

from language import (
    FIRST_WORDS,
    PACKAGES,
    ROOT,
    bound_names,
    docstrings,
    files,
    is_banned,
    violations,
    violations_of_prose,
)


def test_names_and_sentences_are_plain() -> None:
    checked = files([*ROOT.glob("*.md"), *(ROOT / name for name in PACKAGES)])
    assert [line for path in checked for line in violations(path)] == []


def test_tests_begin_their_docstrings_plainly() -> None:
    """Docstrings and comments of tests follow the rules of prose; names of tests are sentences of their own."""
    checked = [path for path in files([ROOT / "tests"]) if path.suffix == ".py" and path.name != "test_language.py"]
    violating = [
        f"{path.relative_to(ROOT)}:{line}: {text.splitlines()[0]}"
        for path in checked
        for line, text in docstrings(ast.parse(path.read_text()))
        if FIRST_WORDS.match(text)
    ]
    assert violating == []


def test_spelling_is_american() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "codespell_lib", *PACKAGES, "README.md", "config"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.returncode) == ("", 0)


def test_the_checks_find_a_mistake_of_each_kind() -> None:
    """A pronoun, a private word, a docstring's beginning, a long sentence and a private phrase."""
    tree = ast.parse("def f(other): pass\nfor each in (): pass\nclass RivalCause: pass\nrate_dps = 1\n")
    assert {name for _, name in bound_names(tree) if is_banned(name)} == {"RivalCause", "other", "each"}
    texts = docstrings(ast.parse('"""What is."""\nA = 1\n"""Rate."""'))
    assert [text for _, text in texts if FIRST_WORDS.match(text)] == ["What is."]
    assert len(list(violations_of_prose("word " * 27 + ". Short one."))) == 1
    assert len(list(violations_of_prose("It begins anew."))) == 1
