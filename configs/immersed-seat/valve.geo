// SPDX-License-Identifier: Apache-2.0
// A plate 12 x 1 mm, 0.3 mm above its seat y = 0, over a tube of 8 mm in a chamber of 40 x 15 mm. The mesh goes on into the seat: a layer 1 mm deep
// under the plate and 3 mm beyond its edges. Triangles.
DefineConstant[ n = 2 ];  // cells over the gap
mm = 1e-3;
fine = 0.3 * mm / n; near = 0.4 * mm; far = 2 * mm;
Point(1) = {-4 * mm, -15 * mm, 0, far};
Point(2) = {4 * mm, -15 * mm, 0, far};
Point(3) = {4 * mm, -1 * mm, 0, 2 * fine};
Point(4) = {9 * mm, -1 * mm, 0, 2 * fine};
Point(5) = {9 * mm, 0, 0, 2 * fine};
Point(6) = {20 * mm, 0, 0, far};
Point(7) = {20 * mm, 15 * mm, 0, far};
Point(8) = {-20 * mm, 15 * mm, 0, far};
Point(9) = {-20 * mm, 0, 0, far};
Point(10) = {-9 * mm, 0, 0, 2 * fine};
Point(11) = {-9 * mm, -1 * mm, 0, 2 * fine};
Point(12) = {-4 * mm, -1 * mm, 0, 2 * fine};
Point(13) = {-6 * mm, 0.3 * mm, 0, fine};
Point(14) = {-3.5 * mm, 0.3 * mm, 0, fine};
Point(15) = {0, 0.3 * mm, 0, near};
Point(16) = {3.5 * mm, 0.3 * mm, 0, fine};
Point(17) = {6 * mm, 0.3 * mm, 0, fine};
Point(18) = {6 * mm, 1.3 * mm, 0, fine};
Point(19) = {-6 * mm, 1.3 * mm, 0, fine};
For i In {1 : 12}
  Line(i) = {i, i == 12 ? 1 : i + 1};
EndFor
For i In {13 : 19}
  Line(i) = {i, i == 19 ? 13 : i + 1};
EndFor
Curve Loop(1) = {1 : 12};
Curve Loop(2) = {13 : 19};
Plane Surface(1) = {1, 2};
Physical Curve("inlet") = {1};
Physical Curve("tube") = {2, 12};
Physical Curve("layer") = {3, 4, 10, 11};
Physical Curve("walls") = {5, 9};
Physical Curve("outlet") = {6, 8};
Physical Curve("lid") = {7};
Physical Curve("plate") = {13 : 19};
Physical Surface("fluid") = {1};
