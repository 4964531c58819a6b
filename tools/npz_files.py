# SPDX-License-Identifier: Apache-2.0
"""How the tools write .npz files: all of them whole, or none."""

import io
import os

import numpy as np

from safe_pickle import Error


def npz_bytes(arrays):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def write_files(files):
    """Writes {path: bytes}: all of them whole, or none."""
    for path in files:
        if path.is_dir():
            raise Error(f"{path}: is a folder")
    temporary = {path: path.with_name(f".{path.name}.{os.getpid()}.tmp") for path in files}
    try:
        for path, data in files.items():
            with open(temporary[path], "xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
        for path in files:
            os.replace(temporary[path], path)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    finally:
        for path in temporary.values():
            path.unlink(missing_ok=True)
