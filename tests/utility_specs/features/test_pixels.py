"""Images in every form that cameras send them in."""

import struct
import subprocess
import sys
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.errors import FeatureError
from utility_specs.features.pixels import ENCODINGS, MOST_SCANS, SCAN, decoded, of_raw
from utility_specs.features.ros_image import RosImage

BGR = (40, 90, 200)
FLAT = np.full((16, 24, 3), BGR, np.uint8)


def yuv(code: int) -> np.ndarray:
    return cv2.cvtColor(FLAT, code)


def uyvy(order: str) -> bytes:
    """The flat image, two pixels in four bytes."""
    y, u, v = yuv(cv2.COLOR_BGR2YUV_I420).reshape(-1)[[0, 16 * 24, 16 * 24 + 16 * 24 // 4]]
    return bytes({"y": y, "u": u, "v": v}[letter] for letter in order) * (16 * 24 // 2)


def i420(planes: str) -> bytes:
    flat = yuv(cv2.COLOR_BGR2YUV_I420).tobytes()
    y, u, v = flat[:384], flat[384:480], flat[480:]
    if planes == "i420":
        return y + u + v
    first, second = (u, v) if planes == "nv12" else (v, u)
    return y + bytes(byte for pair in zip(first, second, strict=True) for byte in pair)


def bayer(pattern: str) -> bytes:
    value = dict(zip("bgr", BGR, strict=True))
    rows = [[value[pattern[2 * (y % 2) + x % 2]] for x in range(24)] for y in range(16)]
    return np.array(rows, np.uint8).tobytes()


RAW = {
    "bgr8": FLAT.tobytes(),
    "rgb8": FLAT[:, :, ::-1].tobytes(),
    "bgra8": yuv(cv2.COLOR_BGR2BGRA).tobytes(),
    "rgba8": yuv(cv2.COLOR_BGR2RGBA).tobytes(),
    "8UC3": FLAT.tobytes(),
    "mono8": yuv(cv2.COLOR_BGR2GRAY).tobytes(),
    "8UC1": yuv(cv2.COLOR_BGR2GRAY).tobytes(),
    "mono16": (yuv(cv2.COLOR_BGR2GRAY).astype("<u2") * 257).tobytes(),
    "16UC1": (yuv(cv2.COLOR_BGR2GRAY).astype("<u2") * 257).tobytes(),
    "yuv422": uyvy("uyvy"),
    "uyvy": uyvy("uyvy"),
    "yuv422_yuy2": uyvy("yuyv"),
    "yuyv": uyvy("yuyv"),
    **{name: i420(name) for name in ("i420", "nv12", "nv21")},
    **{f"bayer_{pattern}8": bayer(pattern) for pattern in ("rggb", "bggr", "gbrg", "grbg")},
}


def raw(encoding: str, data: bytes, **said) -> RosImage:
    return RosImage(
        **{"height": 16, "width": 24, "encoding": encoding, "big_endian": False, "step": 0} | said, data=data
    )


@pytest.mark.parametrize("reduction", [1, 2, 4, 8])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_raw_pixels_have_the_colour_that_was_taken(encoding, reduction):
    """In each encoding, at each size; a grey image has its lightness."""
    pixels = of_raw(raw(encoding, RAW[encoding]), reduction)
    assert pixels.shape[:2] == (16 // reduction, 24 // reduction)
    truth = BGR if pixels.ndim == 3 else cv2.cvtColor(FLAT, cv2.COLOR_BGR2GRAY)[0, 0]
    assert np.abs(pixels.astype(int) - truth).max() <= 2


@pytest.mark.parametrize(("big_endian", "kind"), [(False, "<u2"), (True, ">u2")])
def test_padded_rows_and_both_byte_orders(big_endian, kind):
    """Bytes beyond a row's pixels are left out."""
    rows = np.zeros((16, 26), kind)
    rows[:, :24] = 128 * 257
    pixels = of_raw(raw("mono16", rows.tobytes(), step=52, big_endian=big_endian), 1)
    assert (pixels == 128).all()


@pytest.mark.parametrize(
    "said",
    [{"width": 25}, {"step": 23}, {"step": 2**32 - 1}, {"width": 0}, {"width": 2**31, "height": 2**31}],
    ids=str,
)
def test_raw_images_that_cannot_be_are_refused(said):
    """Too few bytes for what they say of themselves, or none at all."""
    with pytest.raises(FeatureError):
        of_raw(raw("mono8", RAW["mono8"], **said), 4)


def test_an_unknown_encoding_is_refused():
    """What it means would be a guess."""
    with pytest.raises(FeatureError, match="unknown encoding: 32FC7"):
        of_raw(raw("32FC7", RAW["mono8"]), 4)


@pytest.mark.parametrize("form", [".jpg", ".png", ".webp", ".bmp"])
@pytest.mark.parametrize("reduction", [1, 2, 4, 8])
def test_compressed_images_are_decoded_small(form, reduction):
    """By the factor that was asked for; colours stay."""
    image = np.full((64, 96, 3), BGR, np.uint8)
    pixels = decoded(cv2.imencode(form, image)[1].tobytes(), reduction)
    assert pixels.shape == (64 // reduction, 96 // reduction, 3)
    assert np.abs(pixels.astype(int) - BGR).max() <= 3


@given(
    st.binary(max_size=400),
    st.sampled_from(sorted(ENCODINGS)),
    st.integers(0, 40),
    st.integers(0, 40),
    st.sampled_from([1, 4]),
)
def test_whatever_the_bytes_there_are_pixels_or_an_error(data, encoding, width, height, reduction):
    """Images of odd sizes and broken ones."""
    try:
        pixels = of_raw(raw(encoding, data, width=width, height=height), reduction)
    except (FeatureError, cv2.error):
        return
    assert pixels.dtype == np.uint8
    assert pixels.size


def chunk(kind: bytes, body: bytes) -> bytes:
    """A chunk of a PNG."""
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def python(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60)
    assert not done.stderr
    return done.stdout.strip()


def test_opencv_is_imported_when_a_spec_uses_it_and_not_before():
    """Who needs no images pays nothing; who does pays when the spec is loaded."""
    program = "import sys; from utility_specs.features import ColorFraction; a = 'cv2' in sys.modules; "
    assert python(program + "ColorFraction('red'); print(a, 'cv2' in sys.modules)") == "False True"


@pytest.mark.parametrize(("width", "height"), [(20_000, 20_000), (8192, 4097)])
def test_a_small_payload_that_claims_a_huge_image_is_refused(tmp_path, width, height):
    """A PNG that says in its header that it has so many pixels is not decoded; nothing is logged."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    path = tmp_path / "bomb.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")))
    program = f"""
from pathlib import Path
from utility_specs.features.pixels import decoded
try:
    decoded(Path({str(path)!r}).read_bytes(), 4)
except Exception as error:
    print("MAX_IMAGE_PIXELS" in str(error))
"""
    assert python(program) == "True"


def test_a_png_whose_chunk_is_longer_than_the_payload_is_refused():
    """OpenCV would make room for it, gigabytes; one that lacks nothing is decoded."""
    whole = cv2.imencode(".png", FLAT)[1].tobytes()
    assert decoded(whole, 1).shape == FLAT.shape
    for at in (8, 33):
        with pytest.raises(FeatureError, match="not an image"):
            decoded(whole[:at] + b"\x30" + whole[at + 1 :], 1)


def test_packed_texts_of_a_png_are_not_unpacked(tmp_path):
    """They take time, and libpng logs what is wrong with them."""
    whole = cv2.imencode(".png", FLAT)[1].tobytes()
    texts = chunk(b"zTXt", b"Comment\0\0no zlib") + chunk(b"iTXt", b"Comment\0\1\0\0\0no zlib")
    path = tmp_path / "texts.png"
    path.write_bytes(whole[:33] + texts + whole[33:])
    program = f"""
from pathlib import Path
from utility_specs.features.pixels import decoded
print(decoded(Path({str(path)!r}).read_bytes(), 1).shape)
"""
    assert python(program) == str(FLAT.shape)


def test_a_jpeg_of_many_scans_is_refused():
    """Each goes over the whole image again; a progressive one has ten."""
    whole = cv2.imencode(".jpg", FLAT, [cv2.IMWRITE_JPEG_PROGRESSIVE, 1])[1].tobytes()
    scan = whole[whole.rfind(SCAN) : -2]
    assert decoded(whole, 1).shape == FLAT.shape
    with pytest.raises(FeatureError, match="not an image"):
        decoded(whole[:-2] + scan * MOST_SCANS + whole[-2:], 1)


@pytest.mark.parametrize("form", [".tiff", ".ppm"])
def test_kinds_of_images_that_no_camera_sends_are_refused(form):
    """OpenCV would read them."""
    with pytest.raises(FeatureError, match="not an image"):
        decoded(cv2.imencode(form, FLAT)[1].tobytes(), 4)
