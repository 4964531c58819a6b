# SPDX-License-Identifier: Apache-2.0
"""GS-Dynamics (Zhang et al., CoRL 2024) as a predictor of particles.

Points of the object, farthest from each other, and of the hands are a graph: within a reach, the five
nearest of each. Encoders of points (kind, motion of the hands) and of edges (kinds, offsets in the last
three frames), three rounds of messages, then each point's motion. Rollouts of five frames are the
loss; the object follows by linear blend skinning: as published (src/gnn/model.py, src/config/rope.yaml).

Different here: 128 features where the GPU's has 512, batches of 8 where it has 16, and a time limit, on
a CPU; no loss of lengths. It gets other recordings of the object beside the one.
"""

import torch

from .graph_dynamics import Graph, rollout, train

HISTORY, ROUNDS, FEATURES = 3, 3, 128
NEIGHBOURS, MOST = 5, 100
RATE = 1e-3


def encoder(inputs):
    layers = []
    for size in (inputs, FEATURES, FEATURES):
        layers += [torch.nn.Linear(size, FEATURES), torch.nn.ReLU()]
    return torch.nn.Sequential(*layers)


class GsDynamics(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.of_point = encoder(2 + 3)
        self.of_edge = encoder(2 * 2 + 1 + 3 * HISTORY)
        self.message = torch.nn.Linear(3 * FEATURES, FEATURES)
        self.update = torch.nn.Linear(2 * FEATURES, FEATURES)
        self.motion = torch.nn.Sequential(
            torch.nn.Linear(FEATURES, FEATURES), torch.nn.ReLU(),
            torch.nn.Linear(FEATURES, FEATURES), torch.nn.ReLU(), torch.nn.Linear(FEATURES, 3))

    def forward(self, graph, window, hands):
        """The object's next positions (B,n,3), of the last ones (B,HISTORY,n,3) and of the hands'
        (B,HISTORY+1,c,3), which know the next frame."""
        batch = len(window)
        x = torch.cat([window, hands[:, :-1]], 2)  # (B,H,n+c,3)
        count = x.shape[2]
        action = torch.zeros(batch, count, 3)
        action[:, graph.object:] = hands[:, -1] - hands[:, -2]
        kinds = graph.kinds().expand(batch, -1, -1)
        sender, receiver = graph.edges(x[:, -1])
        places = x.transpose(1, 2).reshape(batch * count, 3 * HISTORY)
        flat = kinds.reshape(batch * count, 2)
        other = (flat[receiver] - flat[sender]).abs().sum(1, keepdim=True)
        edge = self.of_edge(torch.cat([flat[receiver], flat[sender], other,
                                       places[receiver] - places[sender]], 1))
        point = self.of_point(torch.cat([flat, action.reshape(batch * count, 3)], 1))
        effect = point
        for _ in range(ROUNDS):
            message = torch.relu(self.message(torch.cat([edge, effect[receiver], effect[sender]], 1)))
            gathered = torch.zeros_like(effect).index_add(0, receiver, message)
            effect = torch.relu(self.update(torch.cat([point, gathered], 1)) + effect)
        motion = self.motion(effect).reshape(batch, count, 3)[:, :graph.object]
        return window[:, -1] + motion


def predict(recorded, say, others=(), seconds=300):
    torch.manual_seed(0)
    size = float((recorded.start.max(0).values - recorded.start.min(0).values).norm())
    spacing = size / 20  # 0.03 m of their rope of about 0.6 m
    graphs = [Graph(one, spacing, 2.7 * spacing, MOST, NEIGHBOURS) for one in (recorded, *others)]
    model = GsDynamics()
    train(model, graphs, HISTORY, seconds, RATE, say)
    return rollout(model, graphs[0], HISTORY)
