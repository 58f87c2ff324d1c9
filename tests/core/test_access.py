"""Who may use a server: one rule for the app, headsets, rosbridge and Foxglove."""

import pytest

from crowdbot.bridges.socket_server import access_of
from crowdbot.core import AccessPolicy, InputError

HERE = "127.0.0.1:9090"
FOREIGN = (
    "https://evil.example", "null", "", "file://", "http://[", "http://localhost.evil.example", "http://localhost:8080",
    "http://127.0.0.1:9091", "http://evil.example@127.0.0.1", "127.0.0.1:9090",
)  # fmt: skip


@pytest.mark.parametrize("origin", FOREIGN)
def test_a_page_of_others_is_refused_unless_it_knows_the_token_or_is_named(origin):
    assert "are refused" in AccessPolicy("127.0.0.1").refusal(HERE, origin, None)
    asking = AccessPolicy("127.0.0.1", "secret", asks=True)
    assert "are refused" in asking.refusal(HERE, origin, None)
    assert "are refused" in asking.refusal(HERE, origin, "wrong", given=True)
    assert "are refused" in asking.refusal(HERE, origin, "secret"), "a cookie, which the browser adds by itself"
    assert asking.refusal(HERE, origin, "secret", given=True) is None
    assert AccessPolicy("127.0.0.1", origins=(origin,)).refusal(HERE, origin, None) is None
    assert "are refused" in AccessPolicy("127.0.0.1", "", asks=False).refusal(HERE, origin, "", given=True)


@pytest.mark.parametrize("origin", [None, "http://127.0.0.1:9090", "HTTP://127.0.0.1:9090"])
def test_programs_and_own_pages_need_no_token_on_this_machine_and_one_beyond_it(origin):
    assert AccessPolicy("127.0.0.1").refusal(HERE, origin, None) is None
    beyond = AccessPolicy("0.0.0.0", "secret")
    assert "the token is missing" in beyond.refusal(HERE, origin, None)
    assert "the token is missing" in beyond.refusal(HERE, origin, "")
    assert beyond.refusal(HERE, origin, "secret") is None


@pytest.mark.parametrize("host", [None, "", ":", "[", "[::1", "evil.example", "127.0.0.1.evil.example:9090"])
def test_a_request_must_name_this_machine(host):
    origin = f"http://{host}"
    for given in (None, origin):
        assert AccessPolicy("127.0.0.1").refusal(host, given, None)
    assert AccessPolicy("0.0.0.0", "", asks=False).refusal(host, origin, None), "a name that a site points at us"


def test_an_open_server_answers_programs_by_name_and_its_pages_by_address():
    open_to_all = access_of("rosbridge", "0.0.0.0", "", ["/robot/*"], ())
    assert open_to_all.refusal("robot.local:9090", None, "") is None
    assert open_to_all.refusal("192.168.0.2:9090", "http://192.168.0.2:9090", "") is None
    assert "are refused" in open_to_all.refusal("192.168.0.2:9090", "null", "", given=True)
    with pytest.raises(InputError, match=r"foxglove: a server on 0\.0\.0\.0 is open to everybody"):
        access_of("foxglove", "0.0.0.0", "", None, ())
