// SPDX-License-Identifier: Apache-2.0
// Cube, hexahedra.
DefineConstant[ n = 64, edge = 2 * Pi ]; // cells an edge; m
l = edge;
Point(1) = {0, 0, 0};
Point(2) = {l, 0, 0};
Point(3) = {l, l, 0};
Point(4) = {0, l, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1 : 4} = n + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
v() = Extrude {0, 0, l} { Surface{1}; Layers{n}; Recombine; };
Physical Surface("bottom") = {1};
Physical Surface("top") = {v(0)};
Physical Surface("front") = {v(2)};
Physical Surface("right") = {v(3)};
Physical Surface("back") = {v(4)};
Physical Surface("left") = {v(5)};
Physical Volume("fluid") = {v(1)};
