"""Address of the live page with the token that lets its buttons work, for the local user alone."""

from collections.abc import Iterable
from ipaddress import ip_address
from urllib.parse import urlsplit

from gyrodrift.outputs.status import OutputStatus

WEB = "web"


class AddressError(Exception):
    """No page can be controlled from this machine; the text says why."""


def page_url(outputs: Iterable[OutputStatus], token: str) -> str:
    """URL of the first open page on loopback; browsers do not send the part after the `#`.

    Raises
    ------
    AddressError
        If there is none.
    """
    statuses = [status for status in outputs if status.output.partition(":")[0] == WEB]
    pages = [urlsplit(status.address) for status in statuses]
    open_pages = [page for page in pages if page.hostname and page.port]
    if not statuses:
        raise AddressError("no live page is open; start serve with --output web")
    if not open_pages:
        raise AddressError(f"the live page is not open: {statuses[0].problem or 'is being opened'}")
    for page in open_pages:
        host = loopback_of(page.hostname or "")
        if host:
            return f"{page.scheme}://{host}:{page.port}/#token={token}"
    raise AddressError(f"the page listens on {open_pages[0].hostname} alone; its buttons need host=127.0.0.1")


def loopback_of(host: str) -> str:
    """Loopback name under which a server that listens on this host is reached; empty if it is not."""
    if host == "localhost":
        return host
    try:
        address = ip_address(host)
    except ValueError:
        return ""
    if address.is_unspecified:
        return "127.0.0.1" if address.version == 4 else "[::1]"
    name = f"[{host}]" if address.version == 6 else host
    return name if address.is_loopback else ""
