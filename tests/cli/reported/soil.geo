// SPDX-License-Identifier: Apache-2.0
DefineConstant[ n = 4, m1 = 6, m2 = 4 ];
Point(1)={0,0,0}; Point(2)={10,0,0}; Point(3)={10,10,0}; Point(4)={0,10,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};
Transfinite Curve {1,2,3,4}=n+1; Transfinite Surface{1}; Recombine Surface{1};
a[] = Extrude {0,0,30} { Surface{1}; Layers{m1}; Recombine; };
b[] = Extrude {0,0,20} { Surface{a[0]}; Layers{m2}; Recombine; };
Physical Surface("base")={1}; Physical Surface("ground")={b[0]};
Physical Surface("south")={a[2],b[2]}; Physical Surface("east")={a[3],b[3]}; Physical Surface("north")={a[4],b[4]}; Physical Surface("west")={a[5],b[5]};
Physical Volume("rock")={a[1]}; Physical Volume("clay")={b[1]};
