# SPDX-License-Identifier: Apache-2.0
"""PhySPRING: spring-mass twins of real deformable objects, learned from measured points.

    import physpring
    recording = physpring.Recording.from_arrays(points=points, controllers=hands, fps=30, mass=0.06)
    twin = physpring.train(recording)
    print(physpring.evaluate(twin, another_recording))
    physpring.export(twin, 'rope')            # MuJoCo models

SI units, z up. Results are those of the program `physpring`, bit for bit. What is wrong raises
`physpring.Error`, a ValueError, with the program's line; what you should know is a
`physpring.PhyspringWarning`.
"""
from physpring import _core
from physpring._core import Error, Level, Recording, SimulatorState, Twin, kernel
from physpring._diagnosis import Report, diagnose
from physpring._evaluation import Evaluation, Track, evaluate, predict, track
from physpring._export import export
from physpring._many import Sweep, sweep, train_many
from physpring._recordings import load_dataset, record
from physpring._registration import interior, register, split
from physpring._simulation import Simulator, simulate
from physpring._training import train
from physpring._warnings import PhyspringWarning

__version__: str = getattr(_core, '__version__')

__all__ = [
    'Error', 'Evaluation', 'Level', 'PhyspringWarning', 'Recording', 'Report', 'Simulator',
    'SimulatorState', 'Sweep', 'Track', 'Twin', '__version__', 'diagnose', 'evaluate', 'export',
    'interior', 'kernel', 'load_dataset', 'predict', 'record', 'register', 'simulate', 'split',
    'sweep', 'track', 'train', 'train_many'
]
