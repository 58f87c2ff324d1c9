"""Address of the server for headsets: certificate for HTTPS and QR code."""

from __future__ import annotations

import contextlib
import datetime
import io
import ipaddress
import os
import socket
import ssl
from pathlib import Path
from typing import Any

from crowdbot.core import cache_root, import_optional

DAYS = 397
"""Validity; browsers refuse certificates that are valid for longer."""
RENEW = 30
"""A certificate that expires in this number of days is made anew."""


def local_addresses() -> tuple[str, ...]:
    """Return the IPv4 addresses of this machine in its networks; that of the default route first.

    >>> all(ipaddress.ip_address(one).version == 4 for one in local_addresses())
    True
    """
    found: list[str] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe, contextlib.suppress(OSError):
        probe.connect(("192.0.2.1", 9))  # sends nothing
        found.append(probe.getsockname()[0])
    with contextlib.suppress(OSError):
        found += [str(item[4][0]) for item in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)]
    return tuple(address for address in dict.fromkeys(found) if not ipaddress.ip_address(address).is_loopback)


def certificate_files(folder: Path | None = None, addresses: tuple[str, ...] | None = None) -> tuple[Path, Path]:
    """Return the files of a certificate of this machine and of its private key; they are made if needed.

    The certificate is signed by itself, so a headset shows a warning once. It is used until the addresses of
    the machine change or it expires. The key can be read by the user only.

    Args:
        folder: folder of the files (default: that of the user for crowdbot).
        addresses: addresses of the machine (default: all).

    Raises:
        MissingExtra: the package ``cryptography`` is not installed.
    """
    place = (folder or cache_root()) / "vr-certificate"
    names = ("127.0.0.1", *(local_addresses() if addresses is None else addresses))
    certificate, key = place / "certificate.pem", place / "key.pem"
    if not _is_usable(certificate, key, names):
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        _write(certificate, key, names)
    return certificate, key


def tls_context(certificate: Path, key: Path) -> ssl.SSLContext:
    """Return the settings of a server for HTTPS."""
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.load_cert_chain(certificate, key)
    return context


def _is_usable(certificate: Path, key: Path, names: tuple[str, ...]) -> bool:
    x509 = _x509()
    try:
        pem_x509_certificate = x509.load_pem_x509_certificate(certificate.read_bytes())
        tls_context(certificate, key)
        known = pem_x509_certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except (OSError, ValueError, x509.ExtensionNotFound):
        return False
    rest = pem_x509_certificate.not_valid_after_utc - datetime.datetime.now(datetime.UTC)
    return set(names) <= {str(item) for item in known.get_values_for_type(x509.IPAddress)} and rest.days > RENEW


def _write(certificate: Path, key: Path, names: tuple[str, ...]) -> None:
    x509 = _x509()
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec

    secret = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.oid.NameOID.COMMON_NAME, "crowdbot")])
    now = datetime.datetime.now(datetime.UTC)
    owners = [x509.DNSName("localhost"), *(x509.IPAddress(ipaddress.ip_address(name)) for name in names)]
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(secret.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - datetime.timedelta(days=1))
        .not_valid_after(now + datetime.timedelta(days=DAYS - 1))
        .add_extension(x509.SubjectAlternativeName(owners), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([x509.oid.ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(secret, hashes.SHA256())
    )
    pem, style = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
    key.unlink(missing_ok=True)
    with os.fdopen(os.open(key, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(secret.private_bytes(pem, style, serialization.NoEncryption()))
    certificate.write_bytes(made.public_bytes(pem))


def _x509() -> Any:
    return import_optional("cryptography.x509", "a certificate for headsets", "vr")


def link_picture(address: str) -> bytes:
    """Return an address as a QR code in SVG.

    Raises:
        MissingExtra: the package ``segno`` is not installed.

    >>> link_picture("https://192.0.2.1:8700/vr")[:5]
    b'<?xml'
    """
    out = io.BytesIO()
    _code(address).save(out, kind="svg", scale=5, border=4, dark="#000", light="#fff")
    return out.getvalue()


def link_text(address: str) -> str:
    """Return an address as a QR code for a terminal with dark background, two rows of the code in a line.

    Raises:
        MissingExtra: the package ``segno`` is not installed.

    >>> len(link_text("https://192.0.2.1:8700/vr").splitlines()) > 10
    True
    """
    rows = [list(row) for row in _code(address).matrix_iter(border=2)]
    rows += [[0] * len(rows[0])] if len(rows) % 2 else []
    blocks = {(0, 0): "█", (0, 1): "▀", (1, 0): "▄", (1, 1): " "}
    pairs = zip(rows[::2], rows[1::2], strict=True)
    return "\n".join("".join(blocks[a, b] for a, b in zip(up, low, strict=True)) for up, low in pairs)


def _code(address: str) -> Any:
    return import_optional("segno", "the picture of a link", "vr").make(address, error="m", micro=False)
