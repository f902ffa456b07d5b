// SPDX-License-Identifier: Apache-2.0
// Channel of 6 x 4 x 2 m around a plate that stands across the flow; hexahedra. 17 blocks of a 3 x 2 x 3 grid, of
// which the plate is the eighteenth.
DefineConstant[ n = 10 ];  // cells along the height and the width of the plate
DefineConstant[ growth = 1.3 ]; // of neighbouring cells, away from the plate
half = 0.02; // m; of the plate's thickness
h = 1 / n;

x() = {-3, -half, half, 3};
y() = {0, 1, 4};
z() = {-1, -0.5, 0.5, 1};
nx = Round(Log(1 + 3 * (growth - 1) / (h / 2)) / Log(growth));
ny = Round(Log(1 + 3 * (growth - 1) / h) / Log(growth));
nz = Round(Log(1 + 0.5 * (growth - 1) / h) / Log(growth));

// Points i + 4 j + 16 k + 1.
For k In {0 : 3}
  For j In {0 : 2}
    For i In {0 : 3}
      Point(1 + i + 4 * j + 16 * k) = {x(i), y(j), z(k)};
    EndFor
  EndFor
EndFor
// Lines along x, y, z: 1000, 2000, 3000 + the number of their first point.
For k In {0 : 3}
  For j In {0 : 2}
    For i In {0 : 3}
      p = 1 + i + 4 * j + 16 * k;
      If (i < 3)
        Line(1000 + p) = {p, p + 1};
        If (i == 0)
          Transfinite Curve {1000 + p} = nx + 1 Using Progression 1 / growth;
        ElseIf (i == 1)
          Transfinite Curve {1000 + p} = 2;
        Else
          Transfinite Curve {1000 + p} = nx + 1 Using Progression growth;
        EndIf
      EndIf
      If (j < 2)
        Line(2000 + p) = {p, p + 4};
        If (j == 0)
          Transfinite Curve {2000 + p} = n + 1;
        Else
          Transfinite Curve {2000 + p} = ny + 1 Using Progression growth;
        EndIf
      EndIf
      If (k < 3)
        Line(3000 + p) = {p, p + 16};
        If (k == 0)
          Transfinite Curve {3000 + p} = nz + 1 Using Progression 1 / growth;
        ElseIf (k == 1)
          Transfinite Curve {3000 + p} = n + 1;
        Else
          Transfinite Curve {3000 + p} = nz + 1 Using Progression growth;
        EndIf
      EndIf
    EndFor
  EndFor
EndFor
// Surfaces across x, y, z: 4000, 5000, 6000 + the number of their first point; collected by patch.
walls() = {}; inlet() = {}; outlet() = {}; plate() = {}; blocks() = {};
For k In {0 : 3}
  For j In {0 : 2}
    For i In {0 : 3}
      p = 1 + i + 4 * j + 16 * k;
      If (j < 2 && k < 3)
        Curve Loop(4000 + p) = {2000 + p, 3000 + p + 4, -(2000 + p + 16), -(3000 + p)};
        Plane Surface(4000 + p) = {4000 + p};
        If (i == 0)
          inlet() += {4000 + p};
        EndIf
        If (i == 3)
          outlet() += {4000 + p};
        EndIf
        If (j == 0 && k == 1 && (i == 1 || i == 2))
          plate() += {4000 + p};
        EndIf
      EndIf
      If (i < 3 && k < 3)
        is_root = (j == 0 && i == 1 && k == 1);
        If (!is_root)
          Curve Loop(5000 + p) = {1000 + p, 3000 + p + 1, -(1000 + p + 16), -(3000 + p)};
          Plane Surface(5000 + p) = {5000 + p};
        EndIf
        If ((j == 0 || j == 2) && !is_root)
          walls() += {5000 + p};
        EndIf
        If (j == 1 && i == 1 && k == 1)
          plate() += {5000 + p};
        EndIf
      EndIf
      If (i < 3 && j < 2)
        Curve Loop(6000 + p) = {1000 + p, 2000 + p + 1, -(1000 + p + 4), -(2000 + p)};
        Plane Surface(6000 + p) = {6000 + p};
        If (k == 0 || k == 3)
          walls() += {6000 + p};
        EndIf
        If (j == 0 && i == 1 && (k == 1 || k == 2))
          plate() += {6000 + p};
        EndIf
      EndIf
    EndFor
  EndFor
EndFor
For k In {0 : 2}
  For j In {0 : 1}
    For i In {0 : 2}
      p = 1 + i + 4 * j + 16 * k;
      If (!(i == 1 && j == 0 && k == 1))
        Surface Loop(p) = {4000 + p, 4000 + p + 1, 5000 + p, 5000 + p + 4, 6000 + p, 6000 + p + 16};
        Volume(p) = {p};
        Transfinite Volume {p};
        blocks() += {p};
      EndIf
    EndFor
  EndFor
EndFor
Transfinite Surface "*";
Recombine Surface "*";
Physical Surface("inlet") = {inlet()};
Physical Surface("outlet") = {outlet()};
Physical Surface("walls") = {walls()};
Physical Surface("plate") = {plate()};
Physical Volume("fluid") = {blocks()};
