"""Where the parameters of a comparison come from, in sentences: defaults, a config, sessions to tune on."""

from collections.abc import Iterator, Sequence

from gyrodrift.compare.comparison import Comparison, Entry, ParamsFrom

NAMED = 6
"""So many of the training sessions are named."""


def sources(comparison: Comparison) -> list[str]:
    """A sentence for each source; plain text."""
    return [*_given(comparison), _trained(comparison)]


def _given(comparison: Comparison) -> Iterator[str]:
    by_config = [entry for entry in comparison.entries if entry.source is ParamsFrom.CONFIG]
    for entry in by_config:
        yield _by_config(comparison, entry)
    yield f"Every {'other ' * bool(by_config)}method ran with its defaults{' once' * bool(comparison.train)}."


def _by_config(comparison: Comparison, entry: Entry) -> str:
    """What a config says of the parameters of a filter."""
    config = comparison.config
    name, tuning = (config.name, config.tuning) if config is not None else ("", None)
    ran = f"{entry.method.title} ran with the parameters of {name}"
    if tuning is None or tuning.filter != entry.method.key:
        return f"{ran}, which does not say where they come from."
    if tuning.is_default:
        return f"{ran}, which are its defaults: tune found none that are better on held-out sessions."
    effort = [f"{tuning.iterations} evaluations"] if tuning.iterations is not None else []
    effort += [f"seed {tuning.seed}"] if tuning.seed is not None else []
    said = f" ({', '.join(effort)})" if effort else ""
    return f"{ran}, which tune found{said} on {_count(len(tuning.training), 'session')}: {_seen(comparison, entry)}."


def _seen(comparison: Comparison, entry: Entry) -> str:
    seen = len(comparison.seen_by(entry))
    return f"{seen} of those compared are among them" if seen else "none of those compared is among them"


def _trained(comparison: Comparison) -> str:
    if not comparison.train:
        return "Nothing was tuned for this comparison: --train gives sessions to tune every method on."
    more = len(comparison.train) - NAMED
    names = ", ".join(comparison.train[:NAMED]) + (f" and {more} more" if more > 0 else "")
    return (
        f"Tuned rows: each method's own parameters, by the search that tune uses, {comparison.iterations} evaluations "
        f"and seed {comparison.seed} for each, on {names}; where the search ended above what the method ran with "
        "before, that is kept."
    )


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"


def shared(comparison: Comparison, entry: Entry) -> str:
    """What there is to say of a row whose parameters saw sessions that it is scored on; empty otherwise."""
    seen: Sequence[object] = comparison.seen_by(entry)
    return f"tuned on {len(seen)} of these" if seen else ""
