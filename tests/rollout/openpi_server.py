# SPDX-License-Identifier: Apache-2.0
"""A policy server as openpi's, with the msgpack code of the package openpi-client itself.

openpi_server.py BEHAVIOUR LOG.npz [PORT]   prints its port, then serves until it is killed

BEHAVIOUR: good (chunks of 7 actions that push), late (the same, each after 50 ms), pings (a chunk of 200 actions, then a ping; each pong is a line of LOG.npz.pongs),
silent (no answer), nan, shape (7 numbers), text (an error, as openpi tells it, then closes), dead
(closes), reason (closes with one), garbage (no msgpack). The first request is kept in LOG.npz.
"""
import asyncio
import sys

import numpy as np
import websockets
import websockets.asyncio.server
from openpi_client import msgpack_numpy

CHUNK = 7


def actions(state, behaviour):
    """A chunk that moves the hand on by 8 mm a frame along y."""
    count = 200 if behaviour == 'pings' else CHUNK
    chunk = np.tile(state.astype(np.float32), (count, 1))
    chunk[:, 1] += 0.008 * np.arange(1, count + 1, dtype=np.float32)
    if behaviour == 'nan':
        chunk[3, 2] = np.nan
    return chunk[:, :7] if behaviour == 'shape' else chunk


class Server:
    def __init__(self, behaviour, log):
        self.behaviour, self.log, self.requests = behaviour, log, 0

    async def serve(self, connection):
        packer = msgpack_numpy.Packer()
        await connection.send(packer.pack({'name': 'test', 'action_dim': np.int64(8)}))
        async for message in connection:
            request = msgpack_numpy.unpackb(message)
            self.requests += 1
            if self.requests == 1:
                images = {'image_' + name: image for name, image in request['images'].items()}
                np.savez(self.log, state=request['state'], prompt=np.array(request['prompt']),
                         **images)
            await self.answer(connection, request, packer)

    async def answer(self, connection, request, packer):
        if self.behaviour == 'silent':
            await asyncio.sleep(1000)
        elif self.behaviour == 'dead':
            connection.transport.abort()
        elif self.behaviour == 'text':
            await connection.send('Traceback (most recent call last):\n  in infer\n'
                                  'KeyError: the policy failed\n')
            await connection.close(1011, 'Internal server error')
        elif self.behaviour == 'reason':
            await connection.close(1012, 'the server restarts')
        elif self.behaviour == 'garbage':
            await connection.send(b'\xc1\xc1')
        else:
            if self.behaviour == 'late':
                await asyncio.sleep(0.05)
            chunk = actions(request['state'], self.behaviour)
            await connection.send(packer.pack({'actions': chunk, 'server_timing': {'infer_ms': 1.0}}))
            if self.behaviour == 'pings':  # the client needs nothing more, but is still there
                await asyncio.wait_for(await connection.ping(), 10)
                with open(self.log + '.pongs', 'a') as pongs:
                    pongs.write('pong\n')


async def main():
    server = Server(*sys.argv[1:3])
    port = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    async with websockets.asyncio.server.serve(server.serve, '127.0.0.1', port, compression=None,
                                               max_size=None) as running:
        print(running.sockets[0].getsockname()[1], flush=True)
        await asyncio.Future()


asyncio.run(main())
