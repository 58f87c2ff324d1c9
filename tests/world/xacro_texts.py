"""Small xacro files and their expansions; the official xacro 2.1.1 gives the same ones."""

HEAD = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>"

EXPANSIONS = [
    ("<a b='${1 + 2 * 3}' c='${7 // 2}' d='${7 / 2}' e='${2 ** 3 ** 2}' f='${-2 ** 2}'/>",
     "<a b='7' c='3' d='3.5' e='512' f='-4'/>"),
    ("<a b='${pi / 2}' c='${radians(180)}' d='${math.sqrt(2)}' e='${max(1, 2.5)}' f='-${0.23/2}'/>",
     "<a b='1.5707963267948966' c='3.141592653589793' d='1.4142135623730951' e='2.5' f='-0.115'/>"),
    ("<a b='${1 if 2 &gt; 1 else 3}' c='${not True or 1 == 1}' d='${1 &lt; 2 &lt; 3}' e='${\"x\" in \"xyz\"}'/>",
     "<a b='1' c='True' d='True' e='True'/>"),
    ("<a b='$${x}' c='$$(arg y)' d='$' e='5$'/>", "<a b='${x}' c='$(arg y)' d='$' e='5$'/>"),
    ("<xacro:property name='p' value='${q * 2}'/><xacro:property name='q' value='3'/><a b='${p}'/>", "<a b='6'/>"),
    ("<xacro:property name='p' value='1'/><xacro:property name='p' default='2'/><xacro:property name='q' default='5'/>"
     "<a b='${p}${q}'/>", "<a b='15'/>"),
    ("<xacro:property name='t' value='abc'/><a b='${t.upper()}' c='${t[0]}' d='${t[1:]}' e='${t + str(1)}'/>",
     "<a b='ABC' c='a' d='bc' e='abc1'/>"),
    ("<xacro:property name='d' value='${dict(x=1, y=[2, 3])}'/><a b='${d[\"y\"][1]}' c='${len(d)}'/>",
     "<a b='3' c='2'/>"),
    ("<xacro:property name='l' value='${[x * 2 for x in range(4) if x != 1]}'/><a b='${l}'/>", "<a b='[0, 4, 6]'/>"),
    ("<xacro:macro name='m' params='x y:=2 z:=${x_outer}'><a x='${x}' y='${y}' z='${z}'/></xacro:macro>"
     "<xacro:property name='x_outer' value='9'/><xacro:m x='1'/><xacro:m x='a' y='${1+1}b' z=''/>",
     "<a x='1' y='2' z='9'/><a x='a' y='2b' z=''/>"),
    ("<xacro:macro name='m' params='x:=^|4'><a x='${x}'/></xacro:macro><xacro:m/><xacro:property name='x' value='8'/>"
     "<xacro:m/><xacro:m x='1'/>", "<a x='4'/><a x='8'/><a x='1'/>"),
    ("<xacro:macro name='m' params='*one **many'><xacro:insert_block name='many'/><b>"
     "<xacro:insert_block name='one'/></b></xacro:macro>"
     "<xacro:m><o x='${1+1}'/><m><p/><q/></m></xacro:m>", "<p/><q/><b><o x='2'/></b>"),
    ("<xacro:property name='block'><c/><d/></xacro:property><a><xacro:insert_block name='block'/></a>",
     "<a><c/><d/></a>"),
    ("<xacro:if value='${1 == 1}'><a/></xacro:if><xacro:unless value='true'><b/></xacro:unless>"
     "<xacro:if value='0'><c/></xacro:if><xacro:unless value='False'><d/></xacro:unless>", "<a/><d/>"),
    ("<xacro:arg name='n' default='x1'/><a b='$(arg n)' c='${\"$(arg n)\" == \"x1\"}'/>", "<a b='x1' c='True'/>"),
    ("<xacro:macro name='m' params='k'><xacro:if value='${k &gt; 0}'><a k='${k}'/><xacro:m k='${k - 1}'/></xacro:if>"
     "</xacro:macro><xacro:m k='3'/>", "<a k='3'/><a k='2'/><a k='1'/>"),
    ("<xacro:macro name='m' params=''><xacro:property name='p' value='in' scope='global'/></xacro:macro><xacro:m/>"
     "<a b='${p}'/>", "<a b='in'/>"),
    ("<xacro:macro name='m' params=''><xacro:property name='p' value='in'/><a b='${p}'/></xacro:macro>"
     "<xacro:property name='p' value='out'/><xacro:m/><a b='${p}'/>", "<a b='in'/><a b='out'/>"),
    ("<xacro:macro name='m' params='x'><a b='${x}'/></xacro:macro><xacro:call macro='${\"m\"}' x='1'/>", "<a b='1'/>"),
    ("<e><xacro:attribute name='x' value='${1 + 1}'/></e><xacro:element xacro:name='${\"tag\"}' y='1'/>",
     "<e x='2'/><tag y='1'/>"),
    ("<xacro:property name='c' value='1'/><xacro:property name='c' value='${c + 1}' lazy_eval='false'/><a b='${c}'/>",
     "<a b='2'/>"),
    ("<xacro:property name='p' value='0.50'/><xacro:property name='s' value=\"'0.50'\"/><a b='${p}' c='${s}'/>",
     "<a b='0.5' c='0.5'/>"),
    ("<a>text ${1 + 1}</a>", "<a>text 2</a>"),
    ("<a b='${\"%s_%02d\" % (\"w\", 3)}' c='${\"a b\".split()[1]}' d='${round(2.567, 2)}'/>",
     "<a b='w_03' c='b' d='2.57'/>"),
    ("<a b='${sin(0) == 0 and cos(0) == 1}' c='${[1,2,3][-1]}' d='${xacro.tokenize(\"1,2;3\")[2]}'/>",
     "<a b='True' c='3' d='3'/>"),
]  # fmt: skip

ERRORS = [
    ("<a b='${c}'/>", "the name 'c' is not defined"),
    ("<a b='${1 +}'/>", "the expression '1 +' is not understood at its end"),
    ("<a b='${1 / 0}'/>", "divides by zero"),
    ("<a b='${[1][3]}'/>", "there is no item"),
    ("<a b='${{'/>", "has no closing '}'"),
    ("<a b='${1 + \"a\"}'/>", "an expression has no value: unsupported operand"),
    ("<a b='${().__class__}'/>", "a name is expected after '.'"),
    ("<a b='${\"\".format}'/>", "'format' is not an attribute that an expression can use"),
    ("<a b='${math.__dict__}'/>", "a name is expected after '.'"),
    ("<a b='${__import__(\"os\")}'/>", "the name '__import__' is not allowed"),
    ("<a b='${open(\"/etc/passwd\")}'/>", "the name 'open' is not defined"),
    ("<a b='${(lambda: 1)()}'/>", "is not understood at 'lambda'"),
    ("<a b='${9 ** 9 ** 9}'/>", "a power in an expression is too large"),
    ("<a b='${\"a\" * 1000000}'/>", "longer than 10000"),
    ("<a b='${range(100000000)}'/>", "a range has more than 10000 numbers"),
    ("<a b='${\"%9999d\" % 1}'/>", "the format '%9999d' is not supported"),
    ("<a b='${round(1, -1000000000)}'/>", "is not supported"),
    ("<a b='${" + "(" * 60 + "1" + ")" * 60 + "}'/>", "nested more than 40 levels"),
    ("<a b='${" + "1+" * 3000 + "1}'/>", "at most 4000 are allowed"),
    ("<a b='$(env HOME)'/>", "the environment is not read; give --env HOME=VALUE"),
    ("<a b='$(arg x)'/>", "the argument 'x' has no value; give --arg x:=VALUE"),
    ("<a b='$(cwd)'/>", "$(cwd) is not supported"),
    ("<xacro:property name='p' value='${p}'/><a b='${p}'/>", "the property 'p' contains itself: p -> p"),
    ("<xacro:property name='p' value='${q}'/><xacro:property name='q' value='${p}'/><a b='${p}'/>", "contains itself"),
    ("<xacro:property name='1p' value='2'/>", "the property name '1p' must be letters"),
    ("<xacro:property value='2'/>", "needs the attribute 'name'"),
    ("<xacro:macro name='mine' params='a'/><xacro:mane a='1'/>", "'mane' is not defined, did you mean 'mine'?"),
    ("<xacro:macro name='m' params='a'/><xacro:m/>", "the macro needs the parameter 'a'"),
    ("<xacro:macro name='m' params='a'/><xacro:m a='1' b='2'/>", "the macro has no parameter 'b'"),
    ("<xacro:macro name='m' params='*a'/><xacro:m/>", "the macro needs 1 blocks, it is given 0"),
    ("<xacro:macro name='m'><xacro:m/></xacro:macro><xacro:m/>", "macros call each other more than 30 levels deep"),
    ("<xacro:macro name='m' params='k'><xacro:if value='${k &gt; 0}'><xacro:m k='${k-1}'/><xacro:m k='${k-1}'/>"
     "</xacro:if><a/></xacro:macro><xacro:m k='29'/>", "the maximum"),
    ("<xacro:insert_block name='b'/>", "there is no block 'b'"),
    ("<xacro:if value='maybe'/>", "the condition 'maybe' is not true or false"),
    ("<xacro:if value='${xacro.fatal(\"stop\", 1)}'/>", "stop 1"),
]  # fmt: skip
