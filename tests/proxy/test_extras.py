"""What optional parts need."""

from proxy.extras import needs, there


def test_it_says_what_to_install():
    """One wording for all commands."""
    assert f"sendworthy top {needs('top')}" == 'sendworthy top needs the extra "top": pip install "sendworthy[top]"'


def test_whether_a_package_is_installed_is_known_without_loading_it():
    """Packages that nobody has are not there."""
    assert there("zenoh")
    assert not there("sendworthy_has_no_such_package")
