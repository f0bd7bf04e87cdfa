"""Fast Fourier transforms of mixed radix, of many columns at once.

The transforms are those of Stockham (Cochran et al., Proc. IEEE 55, 1664 (1967), doi:10.1109/PROC.1967.5957).
Each column is transformed over its rows, so that the inner loops are over contiguous numbers. Real and
imaginary parts are separate arrays. Lengths have no prime factor above 5. `root` holds the cosines and sines
of the multiples of -2 pi/length, (2, length), or of a multiple of the length.
"""

from __future__ import annotations

import math

from metafem._kernels.compiled import compiled


@compiled
def _stage(radix, length, stride, root, re, im, out_re, out_im):
    """Apply one stage of a transform of `length` with the stride of its numbers, from (re, im) to out."""
    part, every = length // radix, root.shape[1] // length
    for p in range(part):
        start, end = p * stride, radix * p * stride
        jump = part * stride
        if radix == 2:
            c, s = root[0, p * every], root[1, p * every]
            at_a, to_0 = start, end
            at_b, to_1 = start + jump, end + stride
            a0, a1 = re[at_a : at_a + stride], im[at_a : at_a + stride]
            b0, b1 = re[at_b : at_b + stride], im[at_b : at_b + stride]
            o0, p0 = out_re[to_0 : to_0 + stride], out_im[to_0 : to_0 + stride]
            o1, p1 = out_re[to_1 : to_1 + stride], out_im[to_1 : to_1 + stride]
            for q in range(stride):
                a_re, a_im = a0[q], a1[q]
                b_re, b_im = b0[q], b1[q]
                o0[q], p0[q] = a_re + b_re, a_im + b_im
                d_re, d_im = a_re - b_re, a_im - b_im
                o1[q] = d_re * c - d_im * s
                p1[q] = d_re * s + d_im * c
        elif radix == 3:
            c1, s1 = root[0, p * every], root[1, p * every]
            c2, s2 = root[0, 2 * p * every], root[1, 2 * p * every]
            half = 0.5 * math.sqrt(3.0)
            at_a, to_0 = start, end
            at_b, to_1 = start + jump, end + stride
            at_d, to_2 = start + 2 * jump, end + 2 * stride
            a0, a1 = re[at_a : at_a + stride], im[at_a : at_a + stride]
            b0, b1 = re[at_b : at_b + stride], im[at_b : at_b + stride]
            d0, d1 = re[at_d : at_d + stride], im[at_d : at_d + stride]
            o0, p0 = out_re[to_0 : to_0 + stride], out_im[to_0 : to_0 + stride]
            o1, p1 = out_re[to_1 : to_1 + stride], out_im[to_1 : to_1 + stride]
            o2, p2 = out_re[to_2 : to_2 + stride], out_im[to_2 : to_2 + stride]
            for q in range(stride):
                a_re, a_im = a0[q], a1[q]
                b_re, b_im = b0[q], b1[q]
                d_re, d_im = d0[q], d1[q]
                t_re, t_im = b_re + d_re, b_im + d_im
                m_re, m_im = a_re - 0.5 * t_re, a_im - 0.5 * t_im
                u_re, u_im = half * (b_im - d_im), -half * (b_re - d_re)
                o0[q], p0[q] = a_re + t_re, a_im + t_im
                x_re, x_im = m_re + u_re, m_im + u_im
                o1[q] = x_re * c1 - x_im * s1
                p1[q] = x_re * s1 + x_im * c1
                x_re, x_im = m_re - u_re, m_im - u_im
                o2[q] = x_re * c2 - x_im * s2
                p2[q] = x_re * s2 + x_im * c2
        elif radix == 4:
            c1, s1 = root[0, p * every], root[1, p * every]
            c2, s2 = root[0, 2 * p * every], root[1, 2 * p * every]
            c3, s3 = root[0, 3 * p * every], root[1, 3 * p * every]
            at_a, to_0 = start, end
            at_b, to_1 = start + jump, end + stride
            at_d, to_2 = start + 2 * jump, end + 2 * stride
            at_e, to_3 = start + 3 * jump, end + 3 * stride
            a0, a1 = re[at_a : at_a + stride], im[at_a : at_a + stride]
            b0, b1 = re[at_b : at_b + stride], im[at_b : at_b + stride]
            d0, d1 = re[at_d : at_d + stride], im[at_d : at_d + stride]
            e0, e1 = re[at_e : at_e + stride], im[at_e : at_e + stride]
            o0, p0 = out_re[to_0 : to_0 + stride], out_im[to_0 : to_0 + stride]
            o1, p1 = out_re[to_1 : to_1 + stride], out_im[to_1 : to_1 + stride]
            o2, p2 = out_re[to_2 : to_2 + stride], out_im[to_2 : to_2 + stride]
            o3, p3 = out_re[to_3 : to_3 + stride], out_im[to_3 : to_3 + stride]
            for q in range(stride):
                a_re, a_im = a0[q], a1[q]
                b_re, b_im = b0[q], b1[q]
                d_re, d_im = d0[q], d1[q]
                e_re, e_im = e0[q], e1[q]
                t_re, t_im, u_re, u_im = a_re + d_re, a_im + d_im, a_re - d_re, a_im - d_im
                v_re, v_im, w_re, w_im = b_re + e_re, b_im + e_im, b_im - e_im, e_re - b_re
                o0[q], p0[q] = t_re + v_re, t_im + v_im
                x_re, x_im = u_re + w_re, u_im + w_im
                o1[q] = x_re * c1 - x_im * s1
                p1[q] = x_re * s1 + x_im * c1
                x_re, x_im = t_re - v_re, t_im - v_im
                o2[q] = x_re * c2 - x_im * s2
                p2[q] = x_re * s2 + x_im * c2
                x_re, x_im = u_re - w_re, u_im - w_im
                o3[q] = x_re * c3 - x_im * s3
                p3[q] = x_re * s3 + x_im * c3
        else:
            c1, s1 = root[0, p * every], root[1, p * every]
            c2, s2 = root[0, 2 * p * every], root[1, 2 * p * every]
            c3, s3 = root[0, 3 * p * every], root[1, 3 * p * every]
            c4, s4 = root[0, 4 * p * every], root[1, 4 * p * every]
            r1, r2 = 0.25 * (math.sqrt(5.0) - 1.0), -0.25 * (math.sqrt(5.0) + 1.0)
            i1, i2 = math.sqrt(1.0 - r1 * r1), math.sqrt(1.0 - r2 * r2)
            at_a, to_0 = start, end
            at_b, to_1 = start + jump, end + stride
            at_d, to_2 = start + 2 * jump, end + 2 * stride
            at_e, to_3 = start + 3 * jump, end + 3 * stride
            at_f, to_4 = start + 4 * jump, end + 4 * stride
            a0, a1 = re[at_a : at_a + stride], im[at_a : at_a + stride]
            b0, b1 = re[at_b : at_b + stride], im[at_b : at_b + stride]
            d0, d1 = re[at_d : at_d + stride], im[at_d : at_d + stride]
            e0, e1 = re[at_e : at_e + stride], im[at_e : at_e + stride]
            f0, f1 = re[at_f : at_f + stride], im[at_f : at_f + stride]
            o0, p0 = out_re[to_0 : to_0 + stride], out_im[to_0 : to_0 + stride]
            o1, p1 = out_re[to_1 : to_1 + stride], out_im[to_1 : to_1 + stride]
            o2, p2 = out_re[to_2 : to_2 + stride], out_im[to_2 : to_2 + stride]
            o3, p3 = out_re[to_3 : to_3 + stride], out_im[to_3 : to_3 + stride]
            o4, p4 = out_re[to_4 : to_4 + stride], out_im[to_4 : to_4 + stride]
            for q in range(stride):
                a_re, a_im = a0[q], a1[q]
                b_re, b_im = b0[q], b1[q]
                d_re, d_im = d0[q], d1[q]
                e_re, e_im = e0[q], e1[q]
                f_re, f_im = f0[q], f1[q]
                t_re, t_im, u_re, u_im = b_re + f_re, b_im + f_im, b_re - f_re, b_im - f_im
                v_re, v_im, w_re, w_im = d_re + e_re, d_im + e_im, d_re - e_re, d_im - e_im
                o0[q], p0[q] = a_re + t_re + v_re, a_im + t_im + v_im
                m_re, m_im = a_re + r1 * t_re + r2 * v_re, a_im + r1 * t_im + r2 * v_im
                n_re, n_im = i1 * u_im + i2 * w_im, -(i1 * u_re + i2 * w_re)
                x_re, x_im = m_re + n_re, m_im + n_im
                o1[q] = x_re * c1 - x_im * s1
                p1[q] = x_re * s1 + x_im * c1
                x_re, x_im = m_re - n_re, m_im - n_im
                o4[q] = x_re * c4 - x_im * s4
                p4[q] = x_re * s4 + x_im * c4
                m_re, m_im = a_re + r2 * t_re + r1 * v_re, a_im + r2 * t_im + r1 * v_im
                n_re, n_im = i2 * u_im - i1 * w_im, -(i2 * u_re - i1 * w_re)
                x_re, x_im = m_re + n_re, m_im + n_im
                o2[q] = x_re * c2 - x_im * s2
                p2[q] = x_re * s2 + x_im * c2
                x_re, x_im = m_re - n_re, m_im - n_im
                o3[q] = x_re * c3 - x_im * s3
                p3[q] = x_re * s3 + x_im * c3


@compiled
def _stages(length, end, stride, root, re, im, other_re, other_im):
    """Apply the stages of a transform from `length` to `end`; return the arrays of the result, and others."""
    while length > end:
        part, radix = length // end, 5
        for choice in (4, 2, 3):
            if part % choice == 0:
                radix = choice
                break
        _stage(radix, length, stride, root, re, im, other_re, other_im)
        re, im, other_re, other_im = other_re, other_im, re, im
        length //= radix
        stride *= radix
    return re, im, other_re, other_im


@compiled
def padded(length, count, root, re, im, other_re, other_im):
    """Return the transforms of the columns of (length/2, count) that are padded with zeros to `length`.

    The arrays have the size length * count; two of them are returned, after them the two others.
    """
    half = length // 2
    for p in range(half):
        c, s = root[0, p], root[1, p]
        start, end = p * count, 2 * p * count
        for q in range(count):
            a_re, a_im = re[start + q], im[start + q]
            other_re[end + q], other_im[end + q] = a_re, a_im
            other_re[end + count + q] = a_re * c - a_im * s
            other_im[end + count + q] = a_re * s + a_im * c
    return _stages(half, 1, 2 * count, root, other_re, other_im, re, im)


@compiled
def halved(length, count, root, re, im, other_re, other_im):
    """Return the first half of the transforms of the columns of (length, count); arrays as in `padded`."""
    re, im, other_re, other_im = _stages(length, 2, count, root, re, im, other_re, other_im)
    size = length // 2 * count
    for q in range(size):
        other_re[q] = re[q] + re[size + q]
        other_im[q] = im[q] + im[size + q]
    return other_re, other_im, re, im
