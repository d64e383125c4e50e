"""onnxruntime, as models are compared with it."""

from __future__ import annotations

from crossgait.policies.place import Place

try:
    import onnxruntime  # type: ignore[import-untyped]
except ImportError as error:
    raise ImportError("ONNX files need onnx and onnxruntime: pip install crossgait[onnx]") from error

_ERRORS_ALONE = 3


def session(model: str | bytes, source: str) -> onnxruntime.InferenceSession:
    """One on a single thread, of a file or its bytes. Raises ConfigError."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = _ERRORS_ALONE
    try:
        return onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # of no common type
        Place(source, "file").fail("a model that onnxruntime runs", str(error).strip().splitlines()[0])
