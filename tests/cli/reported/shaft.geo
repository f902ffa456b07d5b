// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 1, m = 10, a = 1, l = 5 ];
Point(1) = {-a/2, -a/2, 0}; Point(2) = {a/2, -a/2, 0}; Point(3) = {a/2, a/2, 0}; Point(4) = {-a/2, a/2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve {1:4} = n + 1; Transfinite Surface {1}; Recombine Surface {1};
e[] = Extrude {0, 0, l} { Surface{1}; Layers{m}; Recombine; };
Physical Surface("root") = {1}; Physical Surface("tip") = {e[0]}; Physical Surface("sides") = {e[2], e[3], e[4], e[5]}; Physical Volume("steel") = {e[1]};
