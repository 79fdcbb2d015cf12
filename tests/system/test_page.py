"""The operator's page in a browser: all of it is clicked through, by mouse and by keyboard, at three sizes."""

import signal
from contextlib import ExitStack

import pytest

from tests.pages import SPECS, Fleet, Served, World
from tests.system.browser import Browser
from tests.waiting import wait_until

pytestmark = pytest.mark.system
LIMIT = "400 kbit/s"


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """Three robots with cameras, of which the page asks two themselves, and a demo whose world can be changed."""
    with ExitStack() as closing:
        made = Fleet(tmp_path_factory.mktemp("fleet"), closing, robots=3, limit=LIMIT)
        asked = [made.ground, *made.robots[:2]]
        made.page = Served(*(part for each in asked for part in ("--connect", each.endpoint)))
        closing.callback(made.page.end)
        made.world = World(made.ground.endpoint, ["r1", "r2"])
        closing.callback(made.world.close)
        yield made


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    browser = Browser(tmp_path_factory.mktemp("browser"))
    yield browser
    browser.close()


@pytest.fixture
def browser(chromium):
    """A browser whose pages must not complain of anything."""
    chromium.problems.clear()
    yield chromium
    assert chromium.problems == []


@pytest.fixture
def page(browser, fleet):
    """The page as it is opened with its token, when all of it is there."""
    browser.open(f"{fleet.page.url}#token={fleet.page.token}")
    settled(browser)
    return browser


def settled(browser):
    browser.wait("document.querySelectorAll('#mosaic figure[data-frames]').length === 3", "three cameras")
    browser.wait("document.querySelector('#text').value", "the specs")
    browser.wait("document.querySelectorAll('#fleet tr').length === 4", "the robots")


def says(browser, selector, text):
    try:
        browser.wait(f"document.querySelector({selector!r})?.innerText.includes({text!r})", f"{text!r} in {selector}")
    except AssertionError as error:
        shown = browser.run(f"document.querySelector({selector!r})?.innerText")
        focused = browser.run("document.activeElement.outerHTML.slice(0, 200)")
        raise AssertionError(f"{error}; it says {shown!r}, and what has the focus is {focused}") from None


def test_pictures_move_and_what_is_red_now_is_framed(page, fleet):
    """Also in words, for who does not see the frame; without the token left in the address."""
    assert "token" not in page.run("location.href")
    tile = '#mosaic figure[data-key="robot/r2/camera"]'
    before = int(page.run(f"document.querySelector('{tile}').dataset.frames"))
    page.wait(f"Number(document.querySelector('{tile}').dataset.frames) > {before + 3}", "more frames")
    fleet.cameras[1].red = 1.0
    page.wait(f"document.querySelector('{tile}').matches('.marked')", "the red frame")
    page.wait(f"document.querySelector('{tile} canvas').ariaLabel.endsWith('red now')", "what a screen reader says")
    assert page.run(f"getComputedStyle(document.querySelector('{tile} .red')).display") != "none"
    fleet.cameras[1].red = 0.0
    page.wait(f"!document.querySelector('{tile}').matches('.marked')", "the end of red")
    assert page.run(f"/[0-9.]+\\/s/.test(document.querySelector('{tile} .rate').innerText)")
    assert page.run(f"/s old$/.test(document.querySelector('{tile} .age').innerText)")


def test_robots_and_the_channel_are_told(page):
    """What is dropped and why, how full the channel is, what room costs, and what all of it is worth."""
    says(page, "#fleet", "a limit has no room for it")
    says(page, "#fleet", "only its own daemon knows")
    says(page, "#limits", "throughput: ")
    says(page, "#limits", "1 kB costs ")
    says(page, "#utility", "the best that fits the channel is not known while it runs")
    page.wait("document.querySelector('#limits polyline').getAttribute('points').split(' ').length > 3", "a curve")
    page.click("#fleet tr:nth-child(2) button")
    says(page, "#why-text", "robot/r1/camera of robot r1")
    assert page.run("document.querySelector('#why').open")
    page.press("Escape", code=27)
    page.wait("!document.querySelector('#why').open", "the end of the dialog")


@pytest.mark.parametrize(
    ("name", "mode"),
    [("off", "pass"), ("shadow", "shadow"), ("paper", "enforce"), ("downsampling", "enforce"), ("on", "enforce")],
)
def test_buttons_switch_the_filter(page, fleet, name, mode):
    """All robots say so, and the button stays pressed."""
    button = f"#filters [data-filter={name}]"
    page.click(button)
    says(page, "#outcome", f"r3: mode {mode}")
    page.wait(f"document.querySelector('{button}').ariaPressed === 'true'", "the button")
    assert fleet.robots[2].status()["mode"] == mode
    assert page.run("document.querySelectorAll('#filters [aria-pressed=true]').length") == 1


def test_specs_are_changed_where_they_are_right(page, fleet):
    """Mistakes stand at their lines, and lead there; what is right goes live on all robots."""
    area = "document.getElementById('text')"
    change = "{0}.value = {0}.value.replace({1!r}, {2!r}); {0}.dispatchEvent(new Event('input'))"
    page.run(change.format(area, "video", "vidoe"))
    says(page, "#mistakes", "camera.toml:10")
    assert page.run("document.querySelector('#lines .wrong').innerText") == "10"
    page.click("#mistakes a")
    assert page.run(f"{area}.value.slice({area}.selectionStart, {area}.selectionEnd)") == 'utility = { kind = "vidoe" }'
    page.click("#push")
    says(page, "#specs-state", "not put in force: there are mistakes")
    page.run(change.format(area, "vidoe", "video"))
    page.run(change.format(area, LIMIT, "410 kbit/s"))
    says(page, "#specs-state", "checked: no mistake")
    page.click("#push")
    says(page, "#specs-state", "; put in force on all robots")
    assert (fleet.folder / "r3" / "specs.d" / "camera.toml").read_text() == SPECS.format(limit="410 kbit/s")
    says(page, "#limits", "25.1 kB")
    page.run(change.format(area, "410 kbit/s", "500 kbit/s"))
    page.click("#revert")
    assert "410 kbit/s" in page.run(f"{area}.value")
    page.click("#check")
    says(page, "#specs-state", "checked: no mistake")


def test_a_demos_world_is_changed_where_there_is_one(page, fleet):
    """Its buttons come and go with it."""
    page.wait("!document.querySelector('#demo-channel').hidden", "the demo")
    page.run("(c => { c.value = 12; c.dispatchEvent(new Event('input')) })(document.getElementById('capacity'))")
    page.run("document.getElementById('latency').value = 20; document.getElementById('loss').value = 5")
    says(page, "#capacity-shown", "12 Mbit/s")
    page.click("#demo-channel button")
    says(page, "#outcome", "the channel carries 12 Mbit/s now")
    assert (fleet.world.channel.limit, fleet.world.channel.latency) == (pytest.approx(1.5e6), 0.02)
    assert fleet.world.channel.loss == 0.05
    page.run("document.getElementById('red-robot').value = 'r2'")
    page.click("#demo-red button")
    says(page, "#outcome", "something red is in the path of r2")
    assert fleet.world.reds == ["r2"]
    fleet.world.end()
    page.wait("document.querySelector('#demo-channel').hidden && document.querySelector('#demo-red').hidden", "its end")


def test_without_the_token_the_page_only_shows(browser, fleet):
    """Buttons are off and say why; what is shown is the same."""
    browser.run("sessionStorage.clear()")
    browser.open(fleet.page.url)
    settled(browser)
    says(browser, "#no-token", "open the address")
    assert browser.run("[...document.querySelectorAll('#filters button, #push, #check')].every(b => b.disabled)")
    assert browser.run("document.getElementById('text').readOnly")


def test_it_is_steered_by_keyboard_and_read_by_screen_readers(page):
    """Everything that can be pressed has a name and is reached in order, with a focus that is seen."""
    named = {"button", "textbox", "combobox", "link", "spinbutton", "slider", "meter", "image", "region", "table"}
    nameless = [role for role, name in page.spoken() if role in named and not name]
    assert [role for role in nameless if role != "table"] == []
    page.run("document.activeElement.blur()")
    page.press("Tab", code=9)
    assert page.run("document.activeElement.className") == "skip"
    assert page.run("document.activeElement.getBoundingClientRect().left") >= 0
    reached = []
    for _ in range(60):
        page.press("Tab", code=9)
        reached.append(page.run("document.activeElement.id || document.activeElement.dataset?.filter || ''"))
        if reached[-1] == "text":
            break
        assert page.run("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    assert [each for each in reached if each in ("on", "paper", "file", "text")] == ["on", "paper", "file", "text"]
    page.run("document.querySelector('[data-filter=off]').focus()")
    page.press(" ", code=32, text=" ")
    says(page, "#outcome", "r3: mode pass")
    page.run("document.querySelector('[data-filter=shadow]').focus()")
    page.press("Enter", code=13, text="\r")
    says(page, "#outcome", "r3: mode shadow")
    # Until the mode has come as all watch it, too, what stands above the filters may still move them under the mouse.
    page.wait("document.querySelector('[data-filter=shadow]').ariaPressed === 'true'", "the filter is shown in shadow")
    page.click("#filters [data-filter=on]")
    says(page, "#outcome", "r3: mode enforce")


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("size", [(390, 844), (820, 1180), (1440, 900)])
def test_it_fits_a_phone_a_tablet_and_a_desk(browser, fleet, tmp_path, size, dark):
    """Nothing sticks out to the side, text stands out from its ground, and what is pressed is as large as a finger."""
    width, height = size
    browser.open(f"{fleet.page.url}#token={fleet.page.token}", width=width, height=height, dark=dark)
    settled(browser)
    assert browser.run("document.documentElement.scrollWidth") <= width
    small = "[...document.querySelectorAll('#filters button, .editor button')].filter(b => b.offsetHeight < 44).length"
    assert browser.run(small) == 0
    assert browser.run(CONTRAST) == []
    browser.picture(tmp_path / "page.png")
    assert (tmp_path / "page.png").stat().st_size > 10_000


CONTRAST = """(() => {
  const parts = (text) => text.match(/[\\d.]+/g).map(Number);
  const light = (text) => {
    const linear = (c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const [r, g, b] = parts(text).map((each) => linear(each / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (node) => {
    for (let each = node; each; each = each.parentElement) {
      const colour = getComputedStyle(each).backgroundColor;
      if (parts(colour)[3] !== 0) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  return [...document.querySelectorAll("p, li, b, span, button, th, td, a, h1, h2, label, small, textarea")]
    .filter((node) => node.checkVisibility() && node.innerText?.trim() && !node.disabled)
    .filter((node) => {
      const [a, b] = [light(getComputedStyle(node).color), light(ground(node))].sort((x, y) => y - x);
      return (a + 0.05) / (b + 0.05) < 4.5;
    })
    .map((node) => `${node.tagName} ${node.className} ${node.innerText.slice(0, 30)}`);
})()"""


def test_a_page_comes_back_when_its_server_does(browser, fleet):
    """It says that the server is away meanwhile, and that it tries again."""
    served = Served("--connect", fleet.ground.endpoint)
    browser.open(served.url)
    settled(browser)
    served.end()
    says(browser, "#connection", "trying again")
    browser.problems.clear()  # Chromium counts a refused connection
    wait_until(
        lambda: "trying again" in browser.run("document.querySelector('#connection').innerText"), what="patience"
    )
    browser.open("about:blank")
    browser.problems.clear()


def test_a_long_key_stands_across_its_picture(browser, fleet):
    """Not beside rate and age with a few letters a line; keys are shown of whom no spec covers."""
    browser.open(fleet.page.url, width=390, height=844)
    settled(browser)
    place = "document.querySelector('#mosaic figure[data-key=\"robot/r1/camera\"] figcaption')"
    key = "robot/r1/sensors/front_camera/image_raw/compressed"
    assert browser.run(f"(c => {{ c.querySelector('b').textContent = {key!r}; return c.offsetHeight }})({place})") < 120


def test_of_a_robot_that_went_away_nothing_is_told_as_now(browser, tmp_path):
    """Its last picture stays for ten minutes, and its age; but nobody knows whether it still sees red."""
    with ExitStack() as closing:
        fleet = Fleet(tmp_path, closing, robots=1, limit=LIMIT)
        page = Served("--connect", fleet.ground.endpoint)
        closing.callback(page.end)
        fleet.cameras[0].red = 1.0
        browser.open(page.url)
        tile = '#mosaic figure[data-key="robot/r1/camera"]'
        browser.wait(f"document.querySelector('{tile}')?.matches('.marked')", "the red frame")
        fleet.robots[0].end(signal.SIGKILL)
        browser.wait(f"document.querySelector('{tile}').matches('.old')", "that its picture is old")
        browser.wait(f"!document.querySelector('{tile}').matches('.marked')", "the end of red")
        says(browser, f"{tile} .rate", "0.0/s")
        assert not browser.run(f"document.querySelector('{tile} canvas').ariaLabel").endswith("red now")
        assert browser.run(f"document.querySelector('{tile} .red').hidden")
        browser.run("performance.now = () => 700_000 + Performance.prototype.now.call(performance)")
        browser.wait(f"document.querySelector('{tile}') === null", "that the picture goes")
        assert not browser.run("document.getElementById('no-cameras').hidden")
