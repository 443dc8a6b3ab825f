"""The replay's server under abuse: only its own machine and site get the page, and nothing wears it out."""

from __future__ import annotations

import os
import re
import socket
import struct
import threading
import time
import urllib.request
from collections import Counter
from typing import Final

import numpy as np

import puma_septic as ps
from campaign.moves import move, puma

_OPEN: Final = 200  # connections at once that say nothing
# What a request line and headers may be, and the answers that are right; "" where the connection is closed.
_FORMS: Final = (
    ("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n", ("200",)), ("HEAD / HTTP/1.1\r\nHost: {host}\r\n\r\n", ("200",)),
    ("GET /?x=1 HTTP/1.1\r\nHost: {host}\r\n\r\n", ("200",)),
    ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", ("403",)), ("GET / HTTP/1.1\r\n\r\n", ("400", "403")),
    ("GET / HTTP/1.1\r\nHost: {host}\r\nHost: {host}\r\n\r\n", ("400", "403")),
    ("GET / HTTP/1.1\r\nHost: {host}.evil.example\r\n\r\n", ("403",)),
    ("GET / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example\r\n\r\n", ("403",)),
    ("GET / HTTP/1.1\r\nHost: {host}\r\nOrigin: null\r\n\r\n", ("403",)),
    ("GET / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nOrigin: http://evil.example\r\n\r\n", ("400", "403")),
    ("GET /../../etc/passwd HTTP/1.1\r\nHost: {host}\r\n\r\n", ("404",)),
    ("GET /%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\nHost: {host}\r\n\r\n", ("404",)),
    ("GET //etc/passwd HTTP/1.1\r\nHost: {host}\r\n\r\n", ("404",)),
    ("GET http://evil.example/ HTTP/1.1\r\nHost: {host}\r\n\r\n", ("404",)),
    ("GET /favicon.ico HTTP/1.1\r\nHost: {host}\r\n\r\n", ("404",)),
    *((f"{verb} / HTTP/1.1\r\nHost: {{host}}\r\n\r\n", ("501", "405")) for verb in ("POST", "PUT", "DELETE",
        "OPTIONS")),
    ("TRACE / HTTP/1.1\r\nHost: {host}\r\n\r\n", ("501", "405")),
    ("CONNECT evil.example:443 HTTP/1.1\r\nHost: {host}\r\n\r\n", ("501", "404", "405")),
    ("GET /" + "a" * 70_000 + " HTTP/1.1\r\nHost: {host}\r\n\r\n", ("414",)),
    ("GET / HTTP/1.1\r\nHost: {host}\r\nX: " + "a" * 70_000 + "\r\n\r\n", ("431",)),
    ("GET / HTTP/1.1\r\nHost: {host}\r\n" + "X: 1\r\n" * 300 + "\r\n", ("431",)),
    ("GET / HTTP/9.9\r\nHost: {host}\r\n\r\n", ("505", "400")), ("GET\r\n\r\n", ("400", "")),
    ("\r\n\r\n", ("", "400")), ("\x00\x01\x02\xff\r\n\r\n", ("400", "")),
    ("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n", ("400", "")),
)  # fmt: skip


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """All forms of requests, so many random ones, and connections that say nothing, reset or never read."""
    served = ps.replay(ps.compute_motion(puma(), move()), open_browser=False)
    port = int(served.url.rstrip("/").rpartition(":")[2])
    found: Counter[str] = Counter()
    offences: list[str] = []
    try:
        for text, right in _FORMS:
            status = _status(port, text.format(host=f"127.0.0.1:{port}").encode("latin-1"))
            found[f"answer {status or 'none'}"] += 1
            if status not in right:
                offences.append(f"{text[:60]!r}: {status}, expected {' or '.join(right)}")
        rng = np.random.default_rng([seed, 3])
        for _ in range(count):
            request = _random_request(rng, port)
            status = _status(port, request)
            found[f"random: {status or 'none'}"] += 1
            lines = re.split(rb"\r\n|\r|\n", request)
            hosts = [line.partition(b":")[2].strip() for line in lines if line.lower().startswith(b"host:")]
            if status == "200" and hosts != [b"127.0.0.1:%d" % port]:
                offences.append(f"{request!r}: 200")
        offences += _elsewhere(port)
        threads, size = threading.active_count(), _resident()
        for attack in (_silent, _reset, _unread):
            attack(port)
            if not _serves(port):
                offences.append(f"does not serve any more after {attack.__name__.strip('_')} connections")
        time.sleep(12.0)  # a connection that says nothing is dropped after ten
        if threading.active_count() > threads + 2:
            offences.append(f"{threading.active_count() - threads} threads are left")
        if _resident() - size > 20_000_000:
            offences.append(f"{(_resident() - size) / 1e6:.0f} MB more after the connections")
    finally:
        served.close()
    return found, offences


def _status(port: int, request: bytes) -> str:
    """The code of the first answer; "" where there is none."""
    with socket.create_connection(("127.0.0.1", port), timeout=5.0) as connection:
        try:
            connection.sendall(request)
            connection.shutdown(socket.SHUT_WR)
            answer = connection.recv(4096)
        except OSError:
            return ""
    # To what is no HTTP/1 there is no status line.
    told = re.search(rb"\AHTTP/\S+ (\d+)|\A(\d+): |Error code: (\d+)", answer)
    return next(filter(None, told.groups())).decode() if told else "200" if answer else ""


def _random_request(rng: np.random.Generator, port: int) -> bytes:
    """A right request with some bytes changed, put in or cut."""
    data = bytearray(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n\r\n".encode())
    for _ in range(int(rng.integers(1, 6))):
        k = int(rng.integers(len(data)))
        data[k : k + int(rng.integers(3))] = rng.bytes(int(rng.integers(4)))
    return bytes(data)


def _elsewhere(port: int) -> list[str]:
    """Nobody answers at the other addresses of this machine."""
    offences = []
    own = {address[4][0] for address in socket.getaddrinfo(socket.gethostname(), None)}
    for address in own - {"127.0.0.1"}:
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.settimeout(2.0)
            if probe.connect_ex((address, port)) == 0:
                offences.append(f"answers at {address}")
    return offences


def _silent(port: int) -> None:
    held = [socket.create_connection(("127.0.0.1", port), timeout=5.0) for _ in range(_OPEN)]
    for one in held[::2]:
        one.sendall(b"GET / HT")
    assert _serves(port), "while connections are open that say nothing"
    for one in held:
        one.close()


def _reset(port: int) -> None:
    for _ in range(50):
        one = socket.create_connection(("127.0.0.1", port), timeout=5.0)
        one.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
        one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        one.close()


def _unread(port: int) -> None:
    held = [socket.create_connection(("127.0.0.1", port), timeout=5.0) for _ in range(20)]
    for one in held:
        one.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
    assert _serves(port), "while readers do not read"
    for one in held:
        one.close()


def _serves(port: int) -> bool:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=20.0) as answer:
        return bool(answer.status == 200)


def _resident() -> int:
    """Bytes of this process that are in memory, as Linux tells them."""
    with open("/proc/self/statm", encoding="ascii") as stream:
        return int(stream.read().split()[1]) * os.sysconf("SC_PAGESIZE")
