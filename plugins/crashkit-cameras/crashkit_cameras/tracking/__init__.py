"""Targets found in images and followed through films."""

from crashkit_cameras.tracking.detect import detect, mark
from crashkit_cameras.tracking.follow import follow
from crashkit_cameras.tracking.frame import Frame
from crashkit_cameras.tracking.group import camera_group
from crashkit_cameras.tracking.images import ImageFiles, Video, write_images, write_overlay
from crashkit_cameras.tracking.marker import Limits
from crashkit_cameras.tracking.render import Imaging, Painted, Pose, render, true_position
from crashkit_cameras.tracking.views import combine_views

__all__ = [
    "Frame",
    "ImageFiles",
    "Imaging",
    "Limits",
    "Painted",
    "Pose",
    "Video",
    "camera_group",
    "combine_views",
    "detect",
    "follow",
    "mark",
    "render",
    "true_position",
    "write_images",
    "write_overlay",
]
