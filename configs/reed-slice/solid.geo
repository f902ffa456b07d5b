// SPDX-License-Identifier: Apache-2.0
// The reed of the slice as a solid: 60 x 10 x 0.4 mm, one cell across y.
DefineConstant[ f = 1, w = 0.01, gap = 0.3, n = 4 ]; // n: cells through the thickness
mm = 1e-3;
Point(1) = {0, 0, gap*mm}; Point(2) = {60*mm, 0, gap*mm}; Point(3) = {60*mm, 0, (gap+0.4)*mm}; Point(4) = {0, 0, (gap+0.4)*mm};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1, 3} = Round(60*f)+1; Transfinite Curve {2, 4} = Round(n*f)+1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
out() = Extrude {0, w, 0} { Surface{1}; Layers{1}; Recombine; };
Physical Surface("sides") = {1, out(0)};
Physical Surface("plate") = {out(2), out(3), out(4)};
Physical Surface("root") = {out(5)};
Physical Volume("reed") = {out(1)};
