"""What words in bone names mean: one table from words of many languages and conventions to senses.

Words stand as `names.fold` leaves them: lower case, no accents, full-width forms narrowed. A word may stand under
several senses ("hip" is the pelvis, or with a side the thigh); `joint_names` decides by the company it keeps.
"""

from enum import StrEnum


class Sense(StrEnum):
    """One meaning that a word in a bone name can have."""

    # The trunk
    ROOT = "root"
    HIPS = "hips"
    HIP = "hip"
    BODY = "body"
    ABDOMEN = "abdomen"
    SPINE = "spine"
    CHEST = "chest"
    NECK = "neck"
    HEAD = "head"
    # The head's parts
    FACE = "face"
    JAW = "jaw"
    MOUTH = "mouth"
    EYE = "eye"
    EAR = "ear"
    # Arms
    CLAVICLE = "clavicle"
    SHOULDER = "shoulder"
    ARM = "arm"
    UPPER_ARM = "upper arm"
    LOWER_ARM = "lower arm"
    ELBOW = "elbow"
    WRIST = "wrist"
    HAND = "hand"
    PALM = "palm"
    FINGER = "finger"
    THUMB = "thumb"
    INDEX = "index"
    MIDDLE = "middle"
    RING = "ring"
    LITTLE = "little"
    # Legs
    BUTTOCK = "buttock"
    LEG = "leg"
    UPPER_LEG = "upper leg"
    LOWER_LEG = "lower leg"
    KNEE = "knee"
    ANKLE = "ankle"
    FOOT = "foot"
    PAW = "paw"
    HEEL = "heel"
    TOE = "toe"
    # Creatures
    TAIL = "tail"
    WING = "wing"
    FEATHER = "feather"
    FIN = "fin"
    TENTACLE = "tentacle"
    ANTENNA = "antenna"
    # Things that hang on a body
    HAIR = "hair"
    CLOTH = "cloth"
    FLESH = "flesh"
    PROP = "prop"
    # What qualifies a part
    UPPER = "upper"
    LOWER = "lower"
    FRONT = "front"
    REAR = "rear"
    BIG = "big"
    # What a bone is for in the rig
    CONTROL = "control"
    MECHANISM = "mechanism"
    TWIST = "twist"
    HELPER = "helper"
    END = "end"
    NOISE = "noise"
    # Sides
    LEFT = "left"
    RIGHT = "right"
    CENTER = "center"


DIGITS = (Sense.THUMB, Sense.INDEX, Sense.MIDDLE, Sense.RING, Sense.LITTLE)

_WORDS: dict[Sense, str] = {
    Sense.ROOT: """root master main global world reference origin trajectory cog hara armature skeleton
        wurzel racine raiz radice korzen wortel корень 全ての親 親 センター グルーブ 根 根骨骼 뿌리""",
    Sense.HIPS: """pelv kosi koshi hips pelvis pelvic sacrum becken huefte hufte hueften huften bassin cadera caderas bacino quadril
        bacia miednica biodra bekken heupen kalca таз 腰 下半身 骨盆 臀 臀部 盆骨 골반 엉덩이""",
    Sense.HIP: "hip hanche anca biodro heup",
    Sense.BODY: "body torso trunk korper koerper corps cuerpo corpo tors torse busto rumpf romp cialo 体 身体 몸",
    Sense.ABDOMEN: """abdomen abdominal waist belly stomach lumbar lowerback bauch taille ventre vientre cintura addome
        vita barriga brzuch buik bel живот поясница 腹 허리 배""",
    Sense.SPINE: """spn sebo sebone spine spinal back vertebra vertebrae backbone column wirbelsaule wirbelsaeule wirbel rucken
        ruecken colonne dos columna espina espalda colonna schiena coluna costas kregoslup ruggengraat rug omurga
        позвоночник позвонок спина 上半身 背骨 背 脊椎 脊柱 脊 척추""",
    Sense.CHEST: """mune chest thorax thoracic ribcage rib ribs sternum upperback brust brustkorb poitrine pecho petto torace
        peito klatka borst gogus грудь 胸 胸部 胸腔 가슴""",
    Sense.NECK: "nck kubi neck cervical hals nacken cou cuello collo pescoco szyja nek boyun шея 首 頸 颈 脖 脖子 颈部 목",
    Sense.HEAD: "hd atama head skull cranium kopf schadel tete cabeza testa cabeca glowa hoofd kafa голова 頭 头 头部 頭部 머리",
    Sense.FACE: """kao hana face facial brow eyebrow eyelid lid cheek nose nostril forehead temple chin lip lips teeth tooth
        tongue philtrum snout muzzle whisker smile squint nasolabial dimple crease eyelash lash pupil iris orbicularis
        oculi oris levator risorius temporalis zygomatic frontal gesicht visage cara viso rosto лицо
        舌 眉 瞼 頬 鼻 歯 唇 脸 眉毛 舌头 牙齿 鼻子 얼굴 눈썹 혀 코""",
    Sense.JAW: "ago jaw mandible lowerjaw kiefer unterkiefer machoire mandibula mandibola mascella szczeka kaak челюсть 顎 あご 下巴 颚 턱",
    Sense.MOUTH: """kuchi mouth beak bill maw fang fangs mandibles chelicera chelicerae pincer pincers teeth proboscis
        mund bouche boca bocca usta mond рот 口 嘴 嘴巴 입""",
    Sense.EYE: "me hitomi eye eyeball auge oeil yeux ojo occhio olho oko oog goz глаз 目 眼 眼睛 눈",
    Sense.EAR: "mimi ear ohr oreille oreja orecchio orelha ucho oor kulak ухо 耳 耳朵 귀",
    Sense.CLAVICLE: """clv clvcl sako sakotsu clavicle clav collar collarbone scapula scap schlusselbein schluesselbein clavicule clavicula
        clavicola obojczyk sleutelbeen ключица 鎖骨 锁骨 쇄골""",
    Sense.SHOULDER: "kata sho shoulder shldr shoulders schulter epaule hombro spalla ombro bark schouder omuz 肩 肩膀 어깨",
    Sense.ARM: "ude arm bras brazo braccio braco ramie kol рука 腕 手臂 胳膊 팔",
    Sense.UPPER_ARM: "upperarm uparm humerus bicep biceps oberarm bovenarm плечо 上腕 上臂 大臂 상완 위팔",
    Sense.LOWER_ARM: """lwarm loarm lowerarm forearm radius ulna unterarm onderarm avantbras antebrazo avambraccio antebraco przedramie
        предплечье 前腕 前臂 小臂 전완 아래팔""",
    Sense.ELBOW: "hiji hizi elb elbow ellbogen ellenbogen coude codo gomito cotovelo lokiec elleboog dirsek локоть ひじ 肘 手肘 팔꿈치",
    Sense.WRIST: "tekubi wri wrist handgelenk poignet muneca polso pulso nadgarstek pols запястье 手首 手腕 손목",
    Sense.HAND: "te pincer chela hand hands hnd grasper gripper main mano mao dlon reka el кисть 手 손",
    Sense.PALM: "palm metacarpal metacarpus metatarsal metatarsals metatarsus meta carpal carpus inhand handflache paume palma 手掌 手のひら 손바닥",
    Sense.FINGER: "fing yubi phalanx phalange finger fingers fingr digit doigt dedo dito dita palec vinger parmak палец пальцы 指 手指 손가락",
    Sense.THUMB: """thm oya oyayubi thu thumb thumbs thmb pollex daumen pouce pulgar pollice polegar kciuk duim 親指 拇指 大拇指 엄지 엄지손가락""",
    Sense.INDEX: """idx hito hitosashi ind point index indx pointer indexfinger forefinger zeigefinger zeige indice indicador wskazujacy wijsvinger
        указательный 人指 人差指 人差し指 食指 검지""",
    Sense.MIDDLE: """mdl naka nakayubi middle mid middlefinger mittelfinger mittel majeur medio medius corazon srodkowy middelvinger
        средний 中指 중지""",
    Sense.RING: "rng kusu kusuri rin third ring ringfinger annulaire anular anulare anelar serdeczny ringvinger безымянный 薬指 无名指 無名指 약지",
    Sense.LITTLE: """koyubi pin pnk lit little pinky pinkie pinkey pinke littlefinger kleinfinger kleiner klein auriculaire menique mignolo
        minimo mindinho maly pink мизинец 小指 소지 새끼""",
    Sense.BUTTOCK: "buttock butt glute gluteus hipjoint",
    Sense.LEG: "asi ashi leg legs limb bein jambe pierna gamba perna noga been bacak нога 足 脚 腿 다리",
    Sense.UPPER_LEG: """momo thigh upperleg upleg femur oberschenkel oberbein cuisse muslo coscia coxa udo dij bovenbeen
        uyluk бедро 太もも 大腿 허벅지""",
    Sense.LOWER_LEG: """lwleg loleg sune shin calf lowerleg tibia fibula crus unterschenkel unterbein wade mollet pantorrilla espinilla
        polpaccio stinco canela lydka golen scheen onderbeen baldir голень すね 小腿 脛 종아리 정강이""",
    Sense.KNEE: "hiza kne knee knie genou rodilla ginocchio joelho kolano diz колено ひざ 膝 膝盖 무릎",
    Sense.ANKLE: "ashikubi asikubi ank ankle talus knochel knoechel cheville tobillo caviglia tornozelo kostka enkel лодыжка 足首 脚踝 脚腕 발목",
    Sense.FOOT: "ft foot feet fuss pied pie piede pe stopa voet ayak стопа ступня 脚掌 발",
    Sense.PAW: "paw hoof claw talon talons pfote huf kralle patte garra zampa лапа копыто",
    Sense.HEEL: "heel calcaneus ferse talon heelside かかと 踵 脚跟",
    Sense.TOE: """tsumasaki bal toe toes toebase ball hallux zeh zehe zehen orteil orteils teen tenen
        носок つま先 つまさき 爪先 脚趾 脚尖 발가락""",
    Sense.TAIL: "sippo shippo tail schwanz queue cola coda cauda rabo ogon staart kuyruk хвост 尻尾 しっぽ 尾 尾巴 꼬리",
    Sense.WING: "hane wing wings flugel fluegel aile ala asa skrzydlo vleugel kanat крыло 羽 翼 翅膀 날개",
    Sense.FEATHER: "feather feathers plume feder pluma",
    Sense.FIN: "fin fins flipper flippers fluke dorsal pectoral flosse nageoire aleta pinna плавник ヒレ 鰭 鳍",
    Sense.TENTACLE: "tentacle tentacles feeler tentakel tentacule",
    Sense.ANTENNA: "antenna antennae antenne horn horns antler antlers crest mane",
    Sense.HAIR: """kami hair hairs ponytail braid bang bangs fringe pigtail beard mustache haar cheveux pelo capelli cabelo
        волосы 髪 前髪 もみあげ 头发 頭髪 머리카락""",
    Sense.CLOTH: """skirt cloth clothes cape cloak coat dress robe ribbon scarf tie sleeve belt pants shirt jacket
        hood hat helmet glove boot strap tassel apron rock kleid スカート 裙 裙子 치마 リボン 帽子""",
    Sense.FLESH: "breast breasts bust boob boobs pec pecs pectoralis muscle jiggle fat butt groin genital penis おっぱい 乳",
    Sense.PROP: """buki tate weapon sword gun rifle pistol shield bow knife axe staff wand prop props item socket slot handslot
        attach attachment holder mount bag backpack quiver sheath scabbard holster camera glasses earring
        武器 剣 剑""",
    Sense.UPPER: "upper upr up high top ober sup oben",
    Sense.LOWER: "lower lwr low lo under unter inf down",
    Sense.FRONT: "front fore vorder vorn avant delantero anterior 前",
    Sense.REAR: "rear hind back hinter arriere trasero posterior 後 后",
    Sense.BIG: "big great",
    Sense.CONTROL: """ik fk ctrl ctl cntrl control controller con target tgt goal pole poletarget polevector pt effector
        handle tweak roll_control properties props switch parent space pivot gizmo ctr aim lookat footsteps
        null locator loc ＩＫ キャンセル""",
    Sense.MECHANISM: "mch org vis wgt widget drv driver proxy virtual dummy dum nub_ctrl",
    Sense.TWIST: "twist twst roll bend_twist torsion rolle 捩 捩り 捻り ねじり 트위스트",
    Sense.HELPER: """helper share sharebone corrective correct fix fixer muscle volume stretch squash dummybone
        leaf_helper offset offs support sub secondary sec physics phys spring collider 補助""",
    Sense.END: "end nub tip leaf effector eff endsite site top_end headtop headnub 先 tipend 末端",
    Sense.NOISE: """joint joints bone bones jnt jt bn bip bind skin def deform sk rig mesh character char geo grp group
        anim base adj bend segment seg part node object nd b j m c x ボーン 骨 骨骼 骨头""",
    Sense.LEFT: """left lft lf lt links linke linker linkes gauche izquierda izquierdo izq sinistra sinistro esquerda
        esquerdo lewa lewy lewe sol левый левая левое лев 左 왼 왼쪽""",
    Sense.RIGHT: """right rgt rt rght rechts rechte rechter rechtes droite droit derecha derecho der destra destro
        direita direito prawa prawy prawe sag правый правая правое прав 右 오른 오른쪽""",
    Sense.CENTER: "center centre central mitte milieu centro",
}


def _table() -> dict[str, tuple[Sense, ...]]:
    out: dict[str, tuple[Sense, ...]] = {}
    for sense, words in _WORDS.items():
        for word in words.split():
            out[word] = (*out.get(word, ()), sense)
    return out


SENSES: dict[str, tuple[Sense, ...]] = _table()
"""Every known word and its senses."""
