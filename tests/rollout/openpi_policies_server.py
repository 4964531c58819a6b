# SPDX-License-Identifier: Apache-2.0
"""A policy server made of openpi's own parts: its msgpack code, and the transforms of its policies
for DROID, LIBERO and ALOHA (third_party/openpi, as they are in openpi). Only the network is missing:
its place takes a fixed chunk of actions.

openpi_policies_server.py droid|libero|aloha LOG.npz     prints its port, then serves

What the transforms made of the first request, and the request, are kept in LOG.npz.
"""
import asyncio
import enum
import pathlib
import sys
import types

import numpy as np
import websockets.asyncio.server
from openpi_client import msgpack_numpy

HERE = pathlib.Path(__file__).parent


def import_policies():
    """openpi's modules, which import of openpi only a base class and an enumeration."""
    class ModelType(str, enum.Enum):  # src/openpi/models/model.py
        PI0 = 'pi0'
        PI0_FAST = 'pi0_fast'
        PI05 = 'pi05'

    class DataTransformFn:  # src/openpi/transforms.py: a protocol
        pass

    for name, members in (('openpi', {}), ('openpi.models', {}),
                          ('openpi.models.model', {'ModelType': ModelType}),
                          ('openpi.transforms', {'DataTransformFn': DataTransformFn})):
        module = types.ModuleType(name)
        module.__dict__.update(members)
        sys.modules[name] = module
        parent, _, own = name.rpartition('.')
        if parent:
            setattr(sys.modules[parent], own, module)
    sys.path.insert(0, str(HERE.parents[1] / 'third_party/openpi'))
    return ModelType


MODEL_TYPE = import_policies()
import aloha_policy  # noqa: E402
import droid_policy  # noqa: E402
import libero_policy  # noqa: E402

INPUTS = {'droid': (droid_policy.DroidInputs(MODEL_TYPE.PI05), droid_policy.DroidOutputs(),
                    droid_policy.make_droid_example()),
          'libero': (libero_policy.LiberoInputs(MODEL_TYPE.PI05), libero_policy.LiberoOutputs(),
                     libero_policy.make_libero_example()),
          'aloha': (aloha_policy.AlohaInputs(adapt_to_pi=False),
                    aloha_policy.AlohaOutputs(adapt_to_pi=False),
                    aloha_policy.make_aloha_example())}


def leaves(tree, prefix=''):
    """Names and values of a tree of dictionaries."""
    if not isinstance(tree, dict):
        return {prefix: tree}
    found = {}
    for key, value in tree.items():
        found.update(leaves(value, f'{prefix}:{key}' if prefix else key))
    return found


def expect_as_example(request, example):
    """Keys, kinds and shapes are those of openpi's own example."""
    asked, known = leaves(request), leaves(example)
    for key, value in asked.items():
        if isinstance(value, str):
            assert isinstance(known[key], str), key
        else:
            assert value.dtype == known[key].dtype, (key, value.dtype)
            assert value.shape == known[key].shape, (key, value.shape)


def chunk(name, state):
    """32 padded numbers an action, as pi0 gives."""
    actions = np.zeros((10, 32), np.float32)
    if name == 'droid':
        actions[:, 0], actions[:, 1], actions[:, 7] = 0.5, -9, 0.9  # -9 is clipped to -1
    elif name == 'libero':
        actions[:, 1], actions[:, 6] = 0.1, 1
    else:
        actions[:, :14] = state + 0.01 * np.arange(1, 11)[:, None]
    return actions


class Server:
    def __init__(self, name, log):
        self.name, self.log, self.first = name, log, True

    async def serve(self, connection):
        packer = msgpack_numpy.Packer()
        await connection.send(packer.pack({}))
        before, after, example = INPUTS[self.name]
        async for message in connection:
            request = msgpack_numpy.unpackb(message)
            expect_as_example(request, example)
            made = before(dict(request))
            if self.first:
                self.first = False
                np.savez(self.log, **{f'made:{k}': v for k, v in leaves(made).items()},
                         **{f'asked:{k.replace("/", "|")}': v for k, v in leaves(request).items()})
            await connection.send(packer.pack(after({'actions': chunk(self.name, made['state'])})))


async def main():
    server = Server(*sys.argv[1:3])
    async with websockets.asyncio.server.serve(server.serve, '127.0.0.1', 0, compression=None,
                                               max_size=None) as running:
        print(running.sockets[0].getsockname()[1], flush=True)
        await asyncio.Future()


asyncio.run(main())
