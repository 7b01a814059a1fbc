"""The crate's random numbers, from numpy: Philox4x64-10 read as u(seed, purpose, step, ray, sample).

    u = (word >> 11) * 2^-53,  word = block(counter = [sample // 4 + 1, ray, step, 0], key = [seed, purpose])[sample % 4]

numpy.random.Philox advances its counter once before the first block, so a generator that starts at
counter [0, ray, step, 0] returns exactly these words in the order of `sample`.

    python tools/philox.py --self-test
"""

import argparse
import sys

import numpy as np

MASK = 2**64 - 1
# Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3", the constants of Philox4x64.
MULTIPLIERS = (0xD2E7470EE14C6C93, 0xCA5A826395121157)
WEYL = (0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B)

# First words and draws, stated in the Rust tests too: (seed, purpose, step, ray) -> words of samples 0..5.
FIRST_WORDS = {
    (7, 3, 2, 5): (
        0xCBD7A611C9ABC8EC,
        0xB9719A6F3A33E058,
        0xAD92A284FB236077,
        0xA642AB82CA657CBA,
        0x6E4CFCD233574DDE,
    ),
    (0, 0, 0, 0): (
        0x02F4BA6408E4D89B,
        0x3DD62B0B9CA8C5B2,
        0x1C8667A55D902E79,
        0x907D7A052FD5B4DC,
        0x809BF322883987C3,
    ),
    (180, 1, 2, 3): (
        0x8D003BFFCF892F59,
        0x9DC6C29327A8B8F0,
        0xDFA0714302E93A97,
        0xF0CED43CE7D27F94,
        0x5444CDDB58405A50,
    ),
    (18446744073709551615, 7, 1000000000000, 1099511627776): (
        0x2FADF007F4C17951,
        0x2D922EFFCA090E1E,
        0x2EAF18F393F8D6B8,
        0x83A9ADD4AE22D129,
        0xED1717AB10D65454,
    ),
}


def words(seed, purpose, step, ray, count):
    """The first `count` 64-bit words of one stream."""
    key = np.array([seed, purpose], dtype=np.uint64)
    counter = np.array([0, ray, step, 0], dtype=np.uint64)
    return np.random.Philox(key=key, counter=counter).random_raw(count)


def uniform(seed, purpose, step, ray, count):
    """The first `count` numbers u in [0, 1) of one stream, each a multiple of 2^-53."""
    return (words(seed, purpose, step, ray, count) >> np.uint64(11)) * 2.0**-53


def block(counter, key):
    """One block of Philox4x64-10, written out: the definition that numpy is checked against."""
    c, k = list(counter), list(key)
    for _ in range(10):
        high0, low0 = divmod(c[0] * MULTIPLIERS[0], 2**64)
        high1, low1 = divmod(c[2] * MULTIPLIERS[1], 2**64)
        c = [high1 ^ c[1] ^ k[0], low1, high0 ^ c[3] ^ k[1], low0]
        k = [(k[0] + WEYL[0]) & MASK, (k[1] + WEYL[1]) & MASK]
    return c


def self_test():
    """Raises AssertionError where numpy, the definition and the stated first words disagree."""
    # The known answer of the authors' own test vectors, at counter and key zero.
    assert block((0, 0, 0, 0), (0, 0))[0] == 0x16554D9ECA36314C
    for (seed, purpose, step, ray), stated in FIRST_WORDS.items():
        from_numpy = [int(w) for w in words(seed, purpose, step, ray, len(stated))]
        defined = [block((i // 4 + 1, ray, step, 0), (seed, purpose))[i % 4] for i in range(len(stated))]
        assert from_numpy == defined == list(stated), (seed, purpose, [hex(w) for w in from_numpy])
        draws = uniform(seed, purpose, step, ray, len(stated))
        assert all(0.0 <= u < 1.0 and u == (w >> 11) / 2**53 for u, w in zip(draws, stated))


def main():
    """`--self-test` checks; otherwise prints the first draws of a stream."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--stream", type=int, nargs=4, default=(0, 0, 0, 0), metavar=("SEED", "PURPOSE", "STEP", "RAY"))
    parser.add_argument("--count", type=int, default=8)
    arguments = parser.parse_args()
    if arguments.self_test:
        self_test()
        print("philox: numpy, the definition and the stated first words agree")
        return 0
    seed, purpose, step, ray = arguments.stream
    for word in words(seed, purpose, step, ray, arguments.count):
        print(f"{int(word):#018x} {(int(word) >> 11) / 2**53!r}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
