"""Sources of the parameters of a comparison in sentences: defaults, a config, tuning."""

from collections.abc import Iterator

from gyrodrift.compare.comparison import Comparison, Entry, ParamsFrom

NAMED = 6
"""Most training sessions that are named."""


def sources(comparison: Comparison) -> list[str]:
    """A sentence for each source, as plain text."""
    return [*_given(comparison), _trained(comparison)]


def _given(comparison: Comparison) -> Iterator[str]:
    by_config = [entry for entry in comparison.entries if entry.source is ParamsFrom.CONFIG]
    for entry in by_config:
        yield _by_config(comparison, entry)
    yield f"Every {'other ' * bool(by_config)}method ran with its defaults."


def _by_config(comparison: Comparison, entry: Entry) -> str:
    """Source of the parameters of a filter in a config."""
    config = comparison.config
    name, tuning = (config.name, config.tuning) if config is not None else ("", None)
    ran = f"{entry.method.title} ran with the parameters of {name}"
    if tuning is None or tuning.filter != entry.method.key:
        return f"{ran}, which has no provenance."
    if tuning.is_default:
        return f"{ran}, which are its defaults: tune found no better parameters on held-out sessions."
    effort = [f"{tuning.iterations} evaluations"] if tuning.iterations is not None else []
    effort += [f"seed {tuning.seed}"] if tuning.seed is not None else []
    details = f" ({', '.join(effort)})" if effort else ""
    return f"{ran}, tuned{details} on {_count(len(tuning.training), 'session')}: {_overlap(comparison, entry)}."


def _overlap(comparison: Comparison, entry: Entry) -> str:
    count = len(comparison.trained_on_by(entry))
    return f"{count} of them are compared here" if count else "none of them is compared here"


def _trained(comparison: Comparison) -> str:
    if not comparison.train:
        return "Nothing was tuned here; --train tunes every method on other sessions."
    unnamed = len(comparison.train) - NAMED
    names = ", ".join(comparison.train[:NAMED]) + (f" and {unnamed} more" if unnamed > 0 else "")
    return (
        f"Tuned rows: every method with {comparison.iterations} evaluations and seed {comparison.seed} on {names}. "
        "Parameters that the search did not improve are kept."
    )


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"


def shared(comparison: Comparison, entry: Entry) -> str:
    """Mark of a row whose training sessions are compared here; empty for other rows."""
    count = len(comparison.trained_on_by(entry))
    return f"tuned on {count} of these" if count else ""
