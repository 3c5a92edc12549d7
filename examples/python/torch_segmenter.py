# SPDX-License-Identifier: BSD-3-Clause
"""A segmenter by PyTorch or ONNX Runtime, whichever the file of the network needs; import it before holdfast.run:

    import torch_segmenter, holdfast
    holdfast.run("run.yaml", {"segmenter": {"network_file": {"file": "network.pt", "classes": ["background",
    "person"]}}})

The network takes float32 (1, 3, rows, columns), red green blue from 0 to 1, and gives scores (1, classes, rows,
columns). A file *.pt or *.pth is TorchScript, *.onnx runs by ONNX Runtime.
"""
import importlib
import pathlib
from typing import Annotated, Any, Callable, List, Tuple

import numpy
import numpy.typing

import holdfast

Images = numpy.typing.NDArray[Any]


def torch_network(file: pathlib.Path) -> Callable[[Images], Images]:
    """A TorchScript network on the graphics processor where there is one."""
    import torch

    device = "cuda" if torch.cuda.is_available() else "cpu"
    jit: Any = torch.jit
    network = jit.load(str(file), map_location=device).eval()

    def infer(image: Images) -> Images:
        with torch.no_grad():
            scores: Images = network(torch.from_numpy(image).to(device)).cpu().numpy()
        return scores

    return infer


def onnx_network(file: pathlib.Path) -> Callable[[Images], Images]:
    """A network by ONNX Runtime with the providers that it has."""
    onnxruntime = importlib.import_module("onnxruntime")

    session = onnxruntime.InferenceSession(str(file), providers=onnxruntime.get_available_providers())
    name = session.get_inputs()[0].name

    def infer(image: Images) -> Images:
        scores: Images = session.run(None, {name: image})[0]
        return scores

    return infer


@holdfast.register("network_file")
class NetworkFile(holdfast.Segmenter):
    """The class with the highest score of a network at each pixel."""

    def __init__(
        self,
        file: Annotated[pathlib.Path, holdfast.Parameter("network, *.pt or *.onnx")],
        classes: Annotated[List[str], holdfast.Parameter("class names by label, the background first")] = [
            "background",
            "person",
        ],
    ) -> None:
        self.classes = list(classes)
        self.infer = onnx_network(file) if file.suffix == ".onnx" else torch_network(file)

    def segment(self, frame: holdfast.Frame) -> Tuple[Images, Images]:
        rgb = frame.colour[:, :, ::-1].astype(numpy.float32) / 255.0
        scores = self.infer(numpy.ascontiguousarray(rgb.transpose(2, 0, 1)[None]))[0]
        if scores.shape != (len(self.classes), *frame.colour.shape[:2]):
            raise ValueError(f"the network gave scores of shape {scores.shape} for {len(self.classes)} classes")
        shifted = numpy.exp(scores - scores.max(axis=0))
        confidence = 255.0 / shifted.sum(axis=0)  # of the best class
        return scores.argmax(axis=0).astype(numpy.uint8), confidence.astype(numpy.uint8)
