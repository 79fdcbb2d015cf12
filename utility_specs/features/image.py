"""What all features of images have in common: where the pixels are in a payload, and in what form."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from utility_specs.features.feature import Feature, FeatureTable
from utility_specs.features.pixels import (
    ENCODINGS,
    LARGEST_IMAGE,
    Pixels,
    Reduction,
    decoded,
    of_compressed_message,
    of_raw,
    opencv,
)
from utility_specs.features.ros_image import RosImage, image_in
from utility_specs.features.sample import Sample
from utility_specs.suggestions import hint, quoted

Form = Literal["compressed", "raw", "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"]

LONGEST_SIDE = 2**16


@dataclass(frozen=True, slots=True)
class Image:
    """How to find the image in a payload; raw ones do not say their `width`, `height` and `encoding` themselves."""

    form: Form = "compressed"
    width: int = 0
    height: int = 0
    encoding: str = ""
    reduction: Reduction = 4

    def __post_init__(self) -> None:
        opencv()  # takes a while to import: at load time, not with the first sample

    def pixels(self, sample: Sample) -> Pixels:
        """Return blue, green and red, or grey; raises FeatureError when there is no image."""
        return sample.once(self, lambda: self._pixels(sample.payload))

    def color(self, sample: Sample) -> Pixels:
        """Return blue, green and red; of a grey image all are alike."""
        cv2, _ = opencv()
        pixels = self.pixels(sample)
        return pixels if pixels.ndim == 3 else cv2.cvtColor(pixels, cv2.COLOR_GRAY2BGR)

    def grey(self, sample: Sample) -> Pixels:
        """Return the lightness of each pixel, from 0 to 255."""
        return sample.once((self, "grey"), lambda: self._grey(sample))

    def _grey(self, sample: Sample) -> Pixels:
        cv2, _ = opencv()
        pixels = self.pixels(sample)
        return pixels if pixels.ndim == 2 else cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)

    def _pixels(self, payload: bytes) -> Pixels:
        match self.form:
            case "compressed":
                return decoded(payload, self.reduction)
            case "raw":
                raw = RosImage(self.height, self.width, self.encoding, big_endian=False, step=0, data=payload)
                return of_raw(raw, self.reduction)
            case "sensor_msgs/msg/Image":
                return of_raw(image_in(payload), self.reduction)
            case "sensor_msgs/msg/CompressedImage":
                return of_compressed_message(payload, self.reduction)


def _encoding(name: str) -> str:
    if name not in ENCODINGS:
        raise ValueError(f"unknown encoding {quoted(name)}" + hint(name, ENCODINGS))
    return name


Side = Annotated[int, Field(ge=1, le=LONGEST_SIDE)]


class ImageTable(FeatureTable):
    """What is said of the image in a payload."""

    format: Form = Field(
        default="compressed",
        description="What the payload is: a JPEG, PNG or WebP; raw pixels; or one of the messages of ROS 2.",
    )
    width: Side | None = Field(default=None, description="Of a raw image, in pixels.")
    height: Side | None = Field(default=None, description="Of a raw image, in pixels.")
    encoding: Annotated[str, AfterValidator(_encoding)] | None = Field(
        default=None, description="Of a raw image: how its pixels are laid out."
    )
    downscale: Reduction = Field(
        default=4, description="By what the image's sides are made shorter before it is looked at."
    )

    @model_validator(mode="after")
    def _described(self) -> Self:
        said = [key for key in ("width", "height", "encoding") if getattr(self, key) is not None]
        if self.format == "raw" and len(said) < 3:
            raise ValueError('format = "raw" needs width, height and encoding')
        if self.format != "raw" and said:
            raise ValueError(f'{said[0]} has a meaning only with format = "raw"')
        if (self.width or 1) * (self.height or 1) > LARGEST_IMAGE:
            raise ValueError(f"an image has at most {LARGEST_IMAGE} pixels")
        if self.format == "raw" and ENCODINGS[self.encoding or ""].uneven(self.width or 0, self.height or 0):
            raise ValueError(
                f"no {self.encoding} image has {self.width} x {self.height} pixels: its sides must be even"
            )
        return self

    def image(self) -> Image:
        """Return how the image is found."""
        return Image(self.format, self.width or 0, self.height or 0, self.encoding or "", self.downscale)

    @abstractmethod
    def feature(self) -> Feature:
        """Return the feature that the table describes."""
