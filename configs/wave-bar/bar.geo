// SPDX-License-Identifier: Apache-2.0
// Bar 1 m long and 0.01 m high, quadrilaterals.
DefineConstant [ n = 200 ]; // cells along
length = 1; height = 0.01; // m
Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = n + 1;
out() = Extrude {0, height, 0} { Curve {1}; Layers {2}; Recombine; };
Physical Curve("sides") = {1, out(0)};
Physical Curve("fixed") = {out(3)};
Physical Curve("pulled") = {out(2)};
Physical Surface("bar") = {out(1)};
