import QtQuick
import Usher.Tablet

// Enough to type the name of a place; accents are not needed to find it.
Item {
    id: keyboard

    required property double u
    readonly property var rows: ["1234567890", "qwertyuiop", "asdfghjkl", "zxcvbnm \b"]
    readonly property double gap: 12 * u
    readonly property double keyWidth: (width - 9 * gap) / 10
    readonly property double keyHeight: (height - 3 * gap) / 4

    signal key(string letter)

    Column {
        spacing: keyboard.gap
        Repeater {
            model: keyboard.rows
            Row {
                id: row
                required property string modelData
                spacing: keyboard.gap
                Repeater {
                    model: row.modelData.length
                    Rectangle {
                        id: cap
                        required property int index
                        readonly property string letter: row.modelData[index]
                        readonly property bool wide: letter === " " || letter === "\b"
                        objectName: "key:" + letter
                        width: keyboard.keyWidth * (wide ? 1.5 : 1) + (wide ? keyboard.gap / 2 : 0)
                        height: keyboard.keyHeight
                        radius: 20 * keyboard.u
                        color: area.pressed ? Theme.focus : Theme.surface
                        Accessible.role: Accessible.Button
                        Accessible.name: letter
                        Text {
                            anchors.centerIn: parent
                            text: cap.letter === "\b" ? "⌫" : cap.letter === " " ? "␣" : cap.letter
                            color: area.pressed ? Theme.ink : Theme.title
                            font.pixelSize: Theme.statusSize * keyboard.u
                        }
                        MouseArea {
                            id: area
                            anchors.fill: parent
                            onPressed: keyboard.key(cap.letter)
                        }
                    }
                }
            }
        }
    }
}
