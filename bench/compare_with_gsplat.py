#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Our pictures of splats beside what gsplat can do on a CPU: compare_with_gsplat.py SPLAT_BENCHMARK

gsplat 1.5.3 draws with CUDA. Its PyTorch code for tests projects splats and evaluates harmonics on a
CPU; to blend them it calls a CUDA kernel again. So its projection and colours alone are timed, and
beside them our whole picture (bench/splat_benchmark.cc), both of 100,000 splats in 640 x 480 pixels,
in turns. Needs torch, and gsplat (`pip install --no-deps gsplat==1.5.3`).
"""

import argparse
import importlib.metadata
import importlib.util
import json
import statistics
import subprocess
import time

import torch

COUNT, WIDTH, HEIGHT, ROUNDS = 100000, 640, 480, 3


def gsplat_functions():
    """Its module for tests alone: the package as a whole begins to compile CUDA when imported."""
    package = importlib.metadata.distribution("gsplat")
    path = package.locate_file("gsplat/cuda/_torch_impl.py")
    spec = importlib.util.spec_from_file_location("torch_impl", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module, package.version


def ball(degree):
    """Splats as those of the benchmark."""
    generator = torch.Generator().manual_seed(1)
    gap = (4 * torch.pi / COUNT) ** 0.5
    means = torch.nn.functional.normalize(torch.randn(COUNT, 3, generator=generator), dim=1)
    scales = gap * (0.3 + 0.4 * torch.rand(COUNT, 3, generator=generator))
    turns = torch.randn(COUNT, 4, generator=generator)
    return means, turns, scales, torch.randn(COUNT, (degree + 1) ** 2, 3, generator=generator)


def time_gsplat(module, degree, threads):
    """Milliseconds."""
    torch.set_num_threads(threads)
    means, turns, scales, harmonics = ball(degree)
    view = torch.eye(4)[None]
    view[0, 2, 3] = 2.4
    intrinsics = torch.tensor([[[HEIGHT, 0, WIDTH / 2], [0, HEIGHT, HEIGHT / 2], [0, 0, 1.0]]])
    times = []
    for _ in range(5):
        begin = time.perf_counter()
        covariances, _ = module._quat_scale_to_covar_preci(turns, scales, compute_preci=False)
        module._fully_fused_projection(means, covariances, view, intrinsics, WIDTH, HEIGHT)
        module._spherical_harmonics(degree, means - torch.tensor([0, 0, -2.4]), harmonics)
        times.append(1e3 * (time.perf_counter() - begin))
    return statistics.median(times)


def time_ours(program, degree, threads):
    name = f"Draw/count:{COUNT}/threads:{threads}/degree:{degree}/real_time"
    done = subprocess.run([program, f"--benchmark_filter=^{name}$", "--benchmark_format=json"],
                          check=True, capture_output=True, text=True)
    return json.loads(done.stdout)["benchmarks"][0]["real_time"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="the built splat_benchmark")
    program = parser.parse_args().program
    module, version = gsplat_functions()
    print(f"100,000 splats, ms; gsplat {version} on PyTorch {torch.__version__}")
    print("| degree | threads | gsplat: projection and colours alone | ours: the whole picture | ratio |")
    print("|---|---|---|---|---|")
    for degree in (0, 3):
        for threads in (1, 2):
            theirs, ours = [], []
            for _ in range(ROUNDS):
                theirs.append(time_gsplat(module, degree, threads))
                ours.append(time_ours(program, degree, threads))
            one, other = statistics.median(theirs), statistics.median(ours)
            print(f"| {degree} | {threads} | {one:.0f} | {other:.0f} | {one / other:.2f} |")


if __name__ == "__main__":
    main()
