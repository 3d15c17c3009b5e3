"""Report of a comparison: one HTML file with means of all methods, then every session."""

from dataclasses import replace

from gyrodrift.compare.comparison import Comparison, ParamsFrom
from gyrodrift.compare.report.files import absence
from gyrodrift.compare.report.over_time import over_time
from gyrodrift.compare.report.sources import shared, sources
from gyrodrift.compare.report.tables import by_folder, by_session, ranking, session_name
from gyrodrift.report.page import Section, page
from gyrodrift.report.provenance import Provenance, UsedFile, provenance


def report_html(comparison: Comparison, made: Provenance) -> str:
    """Page of a comparison with its provenance."""
    sections = [
        _head(comparison, made.set_name),
        ranking(comparison),
        by_folder(comparison),
        over_time(comparison),
        by_session(comparison),
        _methods(comparison),
        provenance(replace(made, sessions=_used(comparison), config=_config_words(comparison))),
    ]
    return page(f"Yaw drift compared on {made.set_name}", sections)


def _head(comparison: Comparison, set_name: str) -> Section:
    """Verdict: the best real-time method, and the next."""
    first, *following = comparison.streaming
    sessions = comparison.sessions
    values = {
        "comparison": comparison,
        "set_name": set_name,
        "minutes": sum(session.session.minutes for session in sessions),
        "first": first,
        "second": following[0] if following else None,
        "mark": shared(comparison, comparison.entries[first]),
        "absent": [f"{method.title} did not run: {absence(method)}." for method in comparison.missing],
        "ahead": sum(
            session.scores[first].e_deg < session.scores[row].e_deg for session in sessions for row in following[:1]
        ),
        "sources": sources(comparison),
    }
    return Section("compare/report/templates/head.html", values)


def _methods(comparison: Comparison) -> Section:
    values = {"entries": comparison.entries, "defaults": ParamsFrom.DEFAULTS, "seconds": comparison.seconds}
    return Section("compare/report/templates/methods.html", values, "Methods and parameters")


def _used(comparison: Comparison) -> list[UsedFile]:
    """Compared sessions, then training sessions."""
    use = "compared" if comparison.train else ""
    used = [UsedFile(session_name(comparison, session), session.session.digest, use) for session in comparison.sessions]
    return used + [
        UsedFile(name, about.digest, "tuning")
        for name, about in zip(comparison.train, comparison.trained_on, strict=True)
    ]


def _config_words(comparison: Comparison) -> str:
    """Sources of the parameters, and the digest of the config."""
    config = comparison.config
    digest = [] if config is None else [f"SHA-256 of {config.name}: {config.sha256}."]
    return " ".join([*sources(comparison), *digest])
