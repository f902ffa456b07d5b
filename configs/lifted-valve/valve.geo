// SPDX-License-Identifier: Apache-2.0
// A plate 12 x 1 mm over a slot of 8 mm, 0.3 mm above its seat; tube below, chamber of 40 x 15 mm above. Triangles.
DefineConstant[ n = 3 ];  // cells over the gap
mm = 1e-3;
fine = 0.3 * mm / n; near = 0.4 * mm; far = 2 * mm;
Point(1) = {-4 * mm, -20 * mm, 0, far};
Point(2) = {4 * mm, -20 * mm, 0, far};
Point(3) = {4 * mm, 0, 0, fine};
Point(4) = {6.5 * mm, 0, 0, fine};
Point(5) = {20 * mm, 0, 0, far};
Point(6) = {20 * mm, 15 * mm, 0, far};
Point(7) = {-20 * mm, 15 * mm, 0, far};
Point(8) = {-20 * mm, 0, 0, far};
Point(9) = {-6.5 * mm, 0, 0, fine};
Point(10) = {-4 * mm, 0, 0, fine};
Point(11) = {-6 * mm, 0.3 * mm, 0, fine};
Point(12) = {-3.5 * mm, 0.3 * mm, 0, fine};
Point(13) = {0, 0.3 * mm, 0, near};
Point(14) = {3.5 * mm, 0.3 * mm, 0, fine};
Point(15) = {6 * mm, 0.3 * mm, 0, fine};
Point(16) = {6 * mm, 1.3 * mm, 0, fine};
Point(17) = {-6 * mm, 1.3 * mm, 0, fine};
For i In {1 : 10}
  Line(i) = {i, i == 10 ? 1 : i + 1};
EndFor
For i In {11 : 17}
  Line(i) = {i, i == 17 ? 11 : i + 1};
EndFor
Curve Loop(1) = {1 : 10};
Curve Loop(2) = {11 : 17};
Plane Surface(1) = {1, 2};
Physical Curve("inlet") = {1};
Physical Curve("outlet") = {5, 7};
Physical Curve("lid") = {6};
Physical Curve("walls") = {2, 3, 4, 8, 9, 10};
Physical Curve("plate") = {11 : 17};
Physical Surface("fluid") = {1};
