// SPDX-License-Identifier: Apache-2.0
// The section of LE11, x being the radius, y the axis.
DefineConstant [ refine = 8, shape = 0 ]; // 2 x 10 cells times refine; shape: 0 quadrilaterals, 1 triangles
s = Sqrt(0.5);
Point(1) = {0, 0, 0};
Point(10) = {1, 0, 0};
Point(11) = {Cos(Pi / 8), Sin(Pi / 8), 0};
Point(12) = {s, s, 0};
Point(13) = {s, 1.24855, 0};
Point(14) = {s, 1.79, 0};
Point(20) = {1.4, 0, 0};
Point(21) = {1.4 * Cos(Pi / 6), 0.7, 0};
Point(22) = {(1.4 * Cos(Pi / 6) + 1) / 2, 1.045, 0};
Point(23) = {1, 1.39, 0};
Point(24) = {1, 1.79, 0};
Circle(10) = {10, 1, 11};
Circle(11) = {11, 1, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Circle(20) = {20, 1, 21};
Line(21) = {21, 22};
Line(22) = {22, 23};
Line(23) = {23, 24};
Line(30) = {10, 20};
Line(31) = {11, 21};
Line(32) = {12, 22};
Line(33) = {13, 23};
Line(34) = {14, 24};
For band In {0 : 3}
  Curve Loop(1 + band) = {30 + band, 20 + band, -(31 + band), -(10 + band)};
  Plane Surface(1 + band) = {1 + band};
EndFor
Transfinite Curve {30 : 34} = 2 * refine + 1;
Transfinite Curve {10, 20} = 4 * refine + 1;
Transfinite Curve {11 : 13, 21 : 23} = 2 * refine + 1;
Transfinite Surface {1 : 4};
If (shape == 0)
  Recombine Surface {1 : 4};
EndIf
Physical Curve("base") = {30};
Physical Curve("top") = {34};
Physical Curve("inside") = {10 : 13};
Physical Curve("outside") = {20 : 23};
Physical Surface("body") = {1 : 4};
