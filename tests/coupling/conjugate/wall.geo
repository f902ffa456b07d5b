// SPDX-License-Identifier: Apache-2.0
// A layer of a wall from x0 to x1, 0.5 m high, of n x m cells.
DefineConstant[ n = 10, m = 10, x0 = 0, x1 = 1 ];
Point(1) = {x0, 0, 0}; Point(2) = {x1, 0, 0}; Point(3) = {x1, 0.5, 0}; Point(4) = {x0, 0.5, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1; Transfinite Curve {2, 4} = m + 1;
Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("left") = {4}; Physical Curve("right") = {2};
Physical Curve("bottom") = {1}; Physical Curve("top") = {3};
Physical Surface("layer") = {1};
