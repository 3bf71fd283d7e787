"""Validate a crate: `python crate_validator.py FOLDER` prints what it must have and has not.

It needs roc-validator, and rocrate for the context that a crate names, so that no network is used.
"""

import sys
from importlib.resources import files
from io import BytesIO
from urllib.request import OpenerDirector
from urllib.response import addinfourl

import requests
from rocrate_validator.models import Severity
from rocrate_validator.services import ValidationSettings, validate

PLACE = "https://w3id.org/ro/crate/"
CONTEXT = files("rocrate").joinpath("data", "ro-crate.jsonld").read_bytes()
TYPE = {"Content-Type": "application/ld+json"}


def opened(opener, request, data=None, timeout=None, former=OpenerDirector.open):
    """What urllib opens, which has the context at hand."""
    url = request if isinstance(request, str) else request.full_url
    if url.startswith(PLACE):
        answer = addinfourl(BytesIO(CONTEXT), TYPE, url, 200)
        answer.msg = "OK"
        return answer
    return former(opener, request, data, timeout)


def requested(session, method, url, former=requests.Session.request, **options):
    """What requests gets, the same."""
    if url.startswith(PLACE):
        answer = requests.Response()
        answer.status_code, answer._content, answer.url = 200, CONTEXT, url
        answer.headers.update(TYPE)
        return answer
    return former(session, method, url, **options)


if __name__ == "__main__":
    OpenerDirector.open = opened
    requests.Session.request = requested
    settings = ValidationSettings(
        rocrate_uri=sys.argv[1], profile_identifier="process-run-crate",
        requirement_severity=Severity.REQUIRED,
    )  # fmt: skip
    issues = validate(settings).get_issues()
    sys.exit("\n".join(f"{one.check.identifier}: {one.message}" for one in issues) or 0)
