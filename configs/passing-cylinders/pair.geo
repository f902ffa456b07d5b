// SPDX-License-Identifier: Apache-2.0
// Two cylinders of diameter 1, one above the other with a gap between them, in a box of 10 x 6: triangles, fine at the
// cylinders and in the gap.
DefineConstant[ n = 24, fine = 4, gap = 0.25 ];  // edges around a cylinder; `fine` times as fine in the gap
h = Pi / n;
Point(1) = {-5, -3, 0, 0.5};
Point(2) = {5, -3, 0, 0.5};
Point(3) = {5, 3, 0, 0.5};
Point(4) = {-5, 3, 0, 0.5};
For i In {0 : 3}
  Line(1 + i) = {1 + i, 1 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1 : 4};
For k In {0 : 1}
  y = k == 0 ? (1 + gap) / 2 : -(1 + gap) / 2;
  p = 10 * (k + 1);
  Point(p) = {0, y, 0, h};
  For i In {0 : 3}
    inside = (k == 0 && i == 3) || (k == 1 && i == 1);
    Point(p + 1 + i) = {0.5 * Cos(i * Pi / 2), y + 0.5 * Sin(i * Pi / 2), 0, inside ? h / fine : h};
  EndFor
  For i In {0 : 3}
    Circle(p + 1 + i) = {p + 1 + i, p, p + 1 + (i + 1) % 4};
  EndFor
  Curve Loop(p) = {p + 1 : p + 4};
EndFor
Plane Surface(1) = {1, 10, 20};
Physical Curve("upper") = {11 : 14};
Physical Curve("lower") = {21 : 24};
Physical Curve("ends") = {2, 4};
Physical Curve("sides") = {1, 3};
Physical Surface("fluid") = {1};
